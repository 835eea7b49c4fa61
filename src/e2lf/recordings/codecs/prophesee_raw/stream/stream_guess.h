// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_stream.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/sinks.h"

namespace e2lf::recordings {

/// What a part that is decoded at the same time as those before it may look at behind its end.
template <WordCodec Codec>
inline constexpr size_t kBytesBehindPart = 2 * kJudgeWords* Codec::kWordBytes;

/// Guesses the state of a stream somewhere ahead from the words in front of that place.
template <WordCodec Codec>
class StreamGuess {
 public:
  using Stream = RawStream<Codec>;

  /// Sets `guess` to the stream at byte `begin` of `bytes`, where `stream` is at the first of them; false when the
  /// words do not tell. Overwrites what is in the sink and leaves it empty.
  static bool at(std::span<const uint8_t> bytes, size_t begin, const SensorLimits& limits, const Stream& stream,
                 ColumnSink& sink, Stream& guess) {
    for (const size_t words : kWarmUpWords) {
      const size_t from = begin - std::min(begin, words * Codec::kWordBytes);
      guess = Stream(limits);
      if (!warm_up(bytes.subspan(from), begin - from, sink, guess) || !guess.is_steady()) continue;
      guess.extrapolate(stream);
      return true;
    }
    return false;
  }

 private:
  /// Words to guess from: a few, or more where these do not tell.
  static constexpr size_t kWarmUpWords[] = {1024, 16384};

  /// Decodes the first `size` of the bytes with a new stream; false when it stops elsewhere.
  static bool warm_up(std::span<const uint8_t> bytes, size_t size, ColumnSink& sink, Stream& stream) {
    DecodeSummary ignored;
    for (size_t at = 0; at != size;) {
      const auto progress = stream.process(bytes.subspan(at), false, at, sink, ignored, size - at);
      at += progress.used;
      sink.count = 0;
      sink.triggers->clear();
      sink.set_latest(INT64_MIN);
      if (progress.wanted > 0 || progress.used == 0 || at > size) return false;
    }
    return true;
  }
};

}  // namespace e2lf::recordings
