// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "e2lf/base/threads.h"
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

/// Decodes consecutive parts of a RAW stream in parallel. The state at the start of a part is guessed from the words
/// before it. A part is accepted only if the previous part ends in exactly this state, so that the result is that of a
/// single thread.
template <WordCodec Codec>
class PartDecoder {
 public:
  using Stream = RawStream<Codec>;

  struct Part {
    explicit Part(const SensorLimits& limits) : stream(limits), guess(limits) {}

    EventBatch batch;
    DecodeSummary summary;          ///< summary of this part only, without the counts of events and triggers
    Stream stream;                  ///< state after the part
    size_t end = 0;                 ///< number of bytes that are done
    int64_t latest_us = INT64_MIN;  ///< time of the last event or trigger so far

    Stream guess;  ///< guessed state before the part
    bool is_guessed = false;
    bool restarts = false;  ///< whether the clock starts again at the end of the part
    bool is_whole = false;  ///< whether the next part begins at the end of this one
  };

  PartDecoder(size_t max_parts, const SensorLimits& limits) : limits_(limits), parts_(max_parts, Part(limits)) {}

  /// Returns the number of bytes that decode() can use.
  [[nodiscard]] size_t wanted_bytes() const { return parts_.size() * part_bytes_ + kBytesBehind; }

  /// Decodes from `bytes`, which begin at the state of `stream` and at byte `first_byte` of the file; `latest_us` is as
  /// in Part. Returns the number of accepted parts, or 0 if there are too few bytes for two.
  size_t decode(std::span<const uint8_t> bytes, uint64_t first_byte, const Stream& stream, int64_t latest_us) {
    const size_t usable = bytes.size() - std::min(bytes.size(), kBytesBehind);
    const size_t count = std::min(parts_.size(), usable / part_bytes_);
    if (count < 2) return 0;
    parallel_for(count, 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) decode_part(bytes, first_byte, stream, i);
    });
    raise(parts_[0], latest_us);
    size_t good = 1;
    while (good < count && joins(parts_[good - 1], parts_[good])) ++good;
    if (parts_[0].end == 0 && !parts_[0].restarts) return 0;
    adapt(good);
    return good;
  }

  [[nodiscard]] Part& part(size_t i) { return parts_[i]; }

 private:
  /// Intended number of events per part, small enough to stay in the cache until they are used.
  static constexpr size_t kPartEvents = size_t{1} << 16;
  static constexpr size_t kMaxPartEvents = 4 * kPartEvents;
  static constexpr size_t kMinPartBytes = size_t{1} << 16;
  static constexpr size_t kMaxPartBytes = size_t{1} << 21;
  static constexpr size_t kBytesBehind = kBytesBehindPart<Codec>;

  void decode_part(std::span<const uint8_t> bytes, uint64_t first_byte, const Stream& stream, size_t i) {
    Part& part = parts_[i];
    EventBatch& batch = part.batch;
    batch.clear();
    part.summary = {};
    ColumnSink sink(batch, kMaxPartEvents);
    const size_t begin = i * part_bytes_;
    part.guess = stream;
    part.is_guessed = i == 0 || StreamGuess<Codec>::at(bytes, begin, limits_, stream, sink, part.guess);
    part.is_whole = part.restarts = false;
    if (part.is_guessed) {
      part.stream = part.guess;
      const auto progress =
          part.stream.process(bytes.subspan(begin), false, first_byte + begin, sink, part.summary, part_bytes_);
      part.end = begin + progress.used;
      part.restarts = progress.restarts;
      part.is_whole = progress.used == part_bytes_ && !part.restarts;
      part.latest_us = sink.latest();
    }
    batch.events.resize(sink.count);
  }

  /// Returns whether a part continues from the previous one, and adapts it if so.
  static bool joins(const Part& before, Part& part) {
    if (!before.is_whole || !part.is_guessed) return false;
    if (!Stream::is_confirmed(part.guess, before.stream, part.stream)) return false;
    raise(part, before.latest_us);
    return true;
  }

  /// Raises times to the last one before the part, as the sink does within it.
  static void raise(Part& part, int64_t latest_us) {
    for (int64_t& t_us : part.batch.events.t) {
      if (t_us >= latest_us) break;
      t_us = latest_us;
    }
    for (Trigger& trigger : part.batch.triggers) trigger.t = std::max(trigger.t, latest_us);
    part.latest_us = std::max(part.latest_us, latest_us);
  }

  void adapt(size_t good) {
    size_t events = 0;
    for (size_t i = 0; i < good; ++i) events += parts_[i].batch.events.size();
    const double bytes_per_event =
        static_cast<double>(parts_[good - 1].end) / static_cast<double>(std::max<size_t>(events, 1));
    const auto wanted = static_cast<size_t>(std::min(1e9, bytes_per_event * static_cast<double>(kPartEvents)));
    part_bytes_ = std::clamp(wanted, kMinPartBytes, kMaxPartBytes) / 64 * 64;
  }

  SensorLimits limits_;
  std::vector<Part> parts_;
  size_t part_bytes_ = 2 * kMinPartBytes;
};

}  // namespace e2lf::recordings
