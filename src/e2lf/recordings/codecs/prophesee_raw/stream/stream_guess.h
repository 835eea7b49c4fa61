// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_stream.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/sinks.h"

namespace e2lf::recordings {

/// Number of bytes after its end that a part which is decoded in parallel may inspect.
template <WordCodec Codec>
inline constexpr size_t kBytesBehindPart = 2 * kJudgeWords* Codec::kWordBytes;

/// Guesses the state of a stream at a later position from the words before that position.
template <WordCodec Codec>
class StreamGuess {
 public:
  using Stream = RawStream<Codec>;

  /// Sets `guess` to the state at byte `begin` of `bytes`, where `stream` is the state at the first byte. Returns false
  /// if the words are not conclusive. Overwrites the content of the sink and leaves it empty.
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
  /// Numbers of words to guess from: a few first, then more.
  static constexpr size_t kWarmUpWords[] = {1024, 16384};

  /// Decodes the first `size` bytes with a new stream; returns false if it stops elsewhere.
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
