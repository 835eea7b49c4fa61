// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "e2lf/recordings/codecs/prophesee_raw/stream/word_codec.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/word_damage.h"

namespace e2lf::recordings {

/// Decodes one RAW encoding from bytes as they arrive; the events do not depend on how the bytes are divided. Words are
/// checked first (WordDamage), and are decoded kHoldWords later without further checks. A copy of the object is a
/// checkpoint from which decoding can continue.
template <typename WordCodec>
class RawStream {
 public:
  explicit RawStream(const SensorLimits& limits) : limits_(limits), damage_(limits) {}

  struct Progress {
    size_t used = 0;        ///< number of bytes that are done
    size_t wanted = 0;      ///< number of bytes needed from there to continue; 0 if the sink stopped
    bool restarts = false;  ///< the clock starts again there, or another header follows: the rest is another stream
  };

  /// Decodes as much of `bytes` as the sink accepts. `first_byte` is the position of bytes[0] in the file, for reports;
  /// `ended` = no bytes follow. At the end, used == bytes.size(). Also stops if the next word would reach beyond the
  /// first `stop` bytes: two streams that stop between the same words of an aligned section have the same state there.
  Progress process(std::span<const uint8_t> bytes, bool ended, uint64_t first_byte, ColumnSink& sink,
                   DecodeSummary& summary, size_t stop = Input::kNoStop) {
    using Step = typename WordDamage<WordCodec>::Step;
    Input input{bytes, 0, stop, ended, first_byte, &summary};
    for (;;) {
      if (input.num_words_to_stop() == 0) return {input.position, 0};
      if (!damage_.find_words(input, state_)) return need_more(input);
      damage_.extend_check(input);
      size_t ready = damage_.num_ready(input);
      if (ready == 0) {
        const Step step = damage_.next_step(input, state_);
        if (step == Step::kNeedMore) return need_more(input);
        if (step == Step::kEnd) return end(input);
        if (step == Step::kRestart) return {input.position, 0, true};
        continue;
      }
      ready = std::min({ready, WordDamage<WordCodec>::kBlockWords, input.num_words_to_stop()});
      if (WordCodec::is_synchronised(state_)) {
        ready = std::min(ready, sink.room(WordCodec::kMaxEventsPerWord));
        if (ready == 0) return {input.position, 0};
        const size_t used = decode(input, ready, sink);
        if (used < ready) return {input.position, 0};
      } else {
        damage_.advance(input, resynchronise(input.data(), ready, summary));
        if (WordCodec::is_synchronised(state_)) damage_.close_gap(time_us(), summary);
      }
    }
  }

  /// Continues after a place where bytes are missing. All bytes before it must have been processed, with `ended` set.
  void pass_break(uint64_t byte, DecodeSummary& summary) { damage_.pass_break(byte, summary, state_); }

  /// Declares a span whose events are not needed. An encoding that cannot leave them out returns them.
  void skip_events(TimeSpan span) { skipped_ = span; }

  [[nodiscard]] int64_t time_us() const { return WordCodec::time(state_); }
  [[nodiscard]] uint64_t time_loops() const { return WordCodec::time_loops(state_); }

  /// Returns the number of bytes after those used that process() has inspected, and which it must receive again.
  [[nodiscard]] size_t num_seen_bytes() const { return damage_.num_seen_bytes(); }

  /// Returns whether decoding continues here as within undamaged data.
  [[nodiscard]] bool is_steady() const { return damage_.is_steady() && WordCodec::is_synchronised(state_); }

  /// Completes the state of a stream that was started shortly before a position: what the words since then have not
  /// determined, such as the loops of the clock, is taken from `before`, an earlier state.
  void extrapolate(const RawStream& before) {
    WordCodec::extrapolate(state_, before.state_);
    damage_.take_heartbeat(before.damage_);
  }

  /// Returns whether `end`, decoded from `guess`, equals the result of decoding from `truth`, with the same events;
  /// corrects the counts in `end` that start at the beginning.
  [[nodiscard]] static bool is_confirmed(const RawStream& guess, const RawStream& truth, RawStream& end) {
    return guess.state_ == truth.state_ &&
           WordDamage<WordCodec>::is_confirmed(guess.damage_, truth.damage_, end.damage_);
  }

 private:
  using Input = WordInput<WordCodec::kWordBytes>;
  static constexpr size_t kWordBytes = WordCodec::kWordBytes;

  Progress need_more(const Input& input) const { return {input.position, input.num_bytes() + 1}; }

  Progress end(Input& input) const {
    if (input.num_bytes() > 0) input.summary->add(Violation::kTruncated, input.byte(0));
    return {input.bytes.size(), 0};
  }

  size_t decode(Input& input, size_t count, ColumnSink& sink) {
    const typename WordCodec::State before = state_;
    size_t used = 0;
    if constexpr (requires { WordCodec::skip_events(input.data(), count, state_, limits_, skipped_, sink); }) {
      used = WordCodec::skip_events(input.data(), count, state_, limits_, skipped_, sink);
    }
    if (used < count) used += WordCodec::decode(input.data() + used * kWordBytes, count - used, state_, limits_, sink);
    if (const uint64_t outside = std::exchange(state_.num_outside, 0); outside > 0) {
      input.summary->add(Violation::kOutOfRange, input.byte(first_outside(input.data(), used, before)), outside);
    }
    if constexpr (requires { WordCodec::count_reports(input.data(), used, state_, *input.summary); }) {
      if (limits_.counts_reports) WordCodec::count_reports(input.data(), used, state_, *input.summary);
    }
    damage_.advance(input, used);
    return used;
  }

  /// The destination of the events of single words.
  struct WordSink {
    EventBatch batch;
    ColumnSink sink{batch, WordCodec::kMaxEventsPerWord};

    /// Decodes a word and returns its number of events and triggers inside the sensor.
    size_t decode(const uint8_t* word, typename WordCodec::State& state, const SensorLimits& limits) {
      sink.count = 0;
      batch.triggers.clear();
      WordCodec::decode_scalar(word, 1, state, limits, sink);
      return sink.count + batch.triggers.size();
    }
  };

  /// Decodes words and drops their events until the state is complete again. Returns the number of words used.
  size_t resynchronise(const uint8_t* words, size_t count, DecodeSummary& summary) {
    WordSink dropped;
    size_t i = 0;
    for (; i < count && !WordCodec::is_synchronised(state_); ++i) {
      WordCodec::take_needed(words + i * kWordBytes, state_);
      const size_t inside = dropped.decode(words + i * kWordBytes, state_, limits_);
      (WordCodec::has_time(state_) ? summary.events_unplaced : summary.events_before_time) +=
          inside + std::exchange(state_.num_outside, 0);
    }
    return i;
  }

  /// Returns the byte of the first word with an event outside the sensor, by decoding from `state` again.
  size_t first_outside(const uint8_t* words, size_t count, typename WordCodec::State state) const {
    WordSink ignored;
    size_t i = 0;
    for (; i < count && state.num_outside == 0; ++i) ignored.decode(words + i * kWordBytes, state, limits_);
    return (i - 1) * kWordBytes;
  }

  SensorLimits limits_;
  typename WordCodec::State state_;
  WordDamage<WordCodec> damage_;
  TimeSpan skipped_;  ///< whose events are not needed
};

}  // namespace e2lf::recordings
