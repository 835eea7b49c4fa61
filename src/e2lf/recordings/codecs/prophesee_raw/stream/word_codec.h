// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// Number of elements after the last event that kernels may overwrite.
inline constexpr size_t kSinkSlack = 64;

/// The size of the sensor, and whether the sensor's own counts are summed.
struct SensorLimits {
  uint32_t width = 2048;
  uint32_t height = 2048;
  bool counts_reports = false;
};

/// The times t with begin_us <= t < end_us.
struct TimeSpan {
  int64_t begin_us = 0, end_us = 0;
};

/// The destination of decoders: pointers to columns of EventColumns, which have kSinkSlack more elements than may be
/// filled.
///   set_time(t)  sets the time of what follows. A time before that of the last event (sensors jitter by some us) is
///                raised to it, so that the output is sorted.
///   room()       returns how many words may be decoded before the sink is full
///   add(x, y, p) adds an event; add_mask(x, y, p, mask) adds an event at x + i for each set bit i, all in the sensor
class ColumnSink {
 public:
  /// Reserves room in a batch and appends to it, at most `max_events` events and as many triggers. Afterwards, the
  /// events must be resized to what was filled.
  ColumnSink(EventBatch& batch, size_t max_events)
      : capacity(max_events), max_triggers(batch.triggers.size() + max_events), triggers(&batch.triggers) {
    EventColumns& events = batch.events;
    const size_t begin = events.size();
    events.resize(begin + max_events + kSinkSlack);
    x = events.x.data() + begin;
    y = events.y.data() + begin;
    p = events.p.data() + begin;
    t = events.t.data() + begin;
  }

  uint16_t* x;
  uint16_t* y;
  uint8_t* p;
  int64_t* t;
  size_t count = 0;
  size_t capacity;      ///< in events; the columns have kSinkSlack more elements
  size_t max_triggers;  ///< largest number of triggers
  std::vector<Trigger>* triggers;

  /// Returns the number of words that may be decoded to the remaining room; 0 = full, or nearly so.
  [[nodiscard]] size_t room(size_t max_events_per_word) const {
    const size_t trigger_room = max_triggers - std::min(max_triggers, triggers->size());
    const size_t words = std::min((capacity - count) / max_events_per_word, trigger_room);
    constexpr size_t kTooFew = 32;
    return count > 0 && words < kTooFew ? 0 : words;
  }

  void set_time(int64_t t_us) { time_ = std::max(latest(), t_us); }
  [[nodiscard]] int64_t time() const { return time_; }

  void add(uint32_t event_x, uint32_t event_y, uint32_t event_p) {
    x[count] = static_cast<uint16_t>(event_x);
    y[count] = static_cast<uint16_t>(event_y);
    p[count] = static_cast<uint8_t>(event_p);
    t[count] = time_;
    ++count;
  }
  void add_mask(uint32_t base_x, uint32_t event_y, uint32_t event_p, uint32_t mask) {
    for (; mask != 0; mask &= mask - 1) add(base_x + static_cast<uint32_t>(std::countr_zero(mask)), event_y, event_p);
  }
  void add_trigger(uint32_t id, uint32_t edge) {
    triggers->push_back({time_, static_cast<uint16_t>(id), static_cast<uint8_t>(edge)});
    latest_ = time_;
  }

  /// Returns the time of the last event or trigger, in this sink or before it.
  [[nodiscard]] int64_t latest() const { return count > 0 ? std::max(latest_, t[count - 1]) : latest_; }
  void set_latest(int64_t t_us) { latest_ = t_us; }

 private:
  int64_t time_ = INT64_MIN;
  int64_t latest_ = INT64_MIN;
};

enum class Verdict { kAccept, kReject, kNeedMore, kRestart };

/// Number of words by which the check is ahead of decoding: damage shows within a few words, and doubtful words are not
/// decoded.
inline constexpr size_t kHoldWords = 32;

/// Number of words that are inspected to determine whether the stream is aligned, and the smallest meaningful number.
inline constexpr size_t kWindowWords = 64;
inline constexpr size_t kMinWindowWords = 16;

/// Number of implausible words that a window may contain: to continue as before (isolated damage), and to resume the
/// stream.
inline constexpr size_t kWindowBad = kWindowWords / 16;
inline constexpr size_t kResumeBad = 1;

/// A longer run of zero words is not data (a simulator may well repeat the event of the first pixel).
inline constexpr uint32_t kMaxZeros = 7;

/// Number of words in which judge_time() looks for another time word.
inline constexpr size_t kJudgeWords = 8192;

/// Number of time words after an unexpected one that are considered.
inline constexpr size_t kJudges = 5;

/// In a stream with a heartbeat, a clock that jumps by more than a second across its wrap into its first second was
/// reset; data are rarely missing exactly there.
inline constexpr int64_t kWrapRestartUs = 1'000'000;

/// The coarse times of an encoding, which count on a circle.
struct CoarseClock {
  uint32_t mask;        ///< range of the times
  unsigned step_bits;   ///< a step is 2^step_bits us
  uint32_t min_fall;    ///< smallest number of steps back that may be a restart of the clock
  uint32_t near_steps;  ///< after damage, the time words that follow the first one are at most this far ahead
  bool believes_next;   ///< whether a step by one needs a single witness, so that live streams do not wait
};

/// Determines whether the coarse time of the first of `count` words, which decreases by at least kClock.min_fall steps,
/// is a restart of the clock. This requires that three quarters of the following coarse times continue from it rather
/// than from `last`. As many are considered as the decrease has steps, but at least kJudges and at most
/// kRestartWitnesses; unexpected ones directly before it count, too.
template <typename WordCodec>
[[nodiscard]] Verdict judge_step_back(const uint8_t* words, size_t count, bool ended, uint32_t last,
                                      const typename WordCodec::Check& check) {
  constexpr uint32_t kMask = WordCodec::kClock.mask;
  uint32_t chain = *WordCodec::coarse_time(words);
  const uint32_t fall = (last - chain) & kMask;
  if (fall < WordCodec::kClock.min_fall) return Verdict::kReject;
  const size_t wanted = std::clamp<size_t>(fall, kJudges, kRestartWitnesses);
  const size_t seen = std::min(count, kJudgeWords);
  size_t counted = std::min<size_t>(check.num_rejected, wanted - 1), in_favour = counted;
  for (size_t i = 1; i < seen && counted < wanted; ++i) {
    const std::optional<uint32_t> following = WordCodec::coarse_time(words + i * WordCodec::kWordBytes);
    if (!following) continue;
    ++counted;
    if (((*following - chain) & kMask) >= ((*following - last) & kMask)) continue;
    ++in_favour;
    chain = *following;
  }
  if (counted < wanted && count < kJudgeWords && !ended) return Verdict::kNeedMore;
  constexpr size_t kFewest = 3;
  return counted >= kFewest && 4 * in_favour >= 3 * counted ? Verdict::kRestart : Verdict::kReject;
}

/// Determines whether an unexpected coarse time, the first of `count` words, is correct, that is, if most of the
/// following ones continue from it rather than from the time before it, which may be unknown. A step back is correct
/// only as a restart of the clock.
template <typename WordCodec>
[[nodiscard]] Verdict judge_coarse_time(const uint8_t* words, size_t count, bool ended,
                                        const typename WordCodec::Check& check) {
  constexpr CoarseClock kClock = WordCodec::kClock;
  const std::optional<uint32_t> last = WordCodec::coarse_time(check);
  const uint32_t time = *WordCodec::coarse_time(words), before = last.value_or(time), half_circle = kClock.mask / 2 + 1;
  const auto steps = [](uint32_t from, uint32_t to) { return (to - from) & kClock.mask; };
  if (steps(before, time) >= half_circle) {
    return judge_step_back<WordCodec>(words, count, ended, before, check);
  }
  const size_t wanted = kClock.believes_next && steps(before, time) == 1 ? 1 : kJudges;
  const size_t seen = std::min(count, kJudgeWords);
  size_t judges = 0, in_favour = 0;
  for (size_t i = 1; i < seen && judges < wanted; ++i) {
    const std::optional<uint32_t> following = WordCodec::coarse_time(words + i * WordCodec::kWordBytes);
    if (!following) continue;
    ++judges;
    const uint32_t limit = last ? steps(before, *following) : check.after_damage ? kClock.near_steps : half_circle;
    in_favour += steps(time, *following) <= limit ? 1 : 0;
  }
  if (judges < wanted && count < kJudgeWords && !ended) return Verdict::kNeedMore;
  return 2 * in_favour > judges || judges == 0 ? Verdict::kAccept : Verdict::kReject;
}

/// A WordCodec is one of the three RAW encodings: words of fixed size, whose meaning depends on earlier words.
/// RawStream decodes all of them through these static functions. `words` points to `count` words.
///
///   kWordBytes, kMaxEventsPerWord, kClock
///   State            the state of decoding
///   Check            the state of the check, which runs ahead of decoding; its `heartbeat` is 0 or more if the stream
///                    repeats its time continually, and `num_rejected` counts consecutive unexpected coarse times
///   coarse_time      returns the coarse time in a word, or the last one of the check; nothing if there is none
///   check            returns the number of plausible words; the next one, if any, needs a closer look
///   count_bad        returns the number of invalid words, up to `enough`; few mean that the stream is aligned. Ignores
///                    the size of the sensor, because headers are known to be wrong about it
///   classify         returns what is implausible about the word at which check() stopped: kUnknownWord, kOutOfRange,
///                    kTimeBackwards or kTimeJump
///   judge_time       determines from the following words whether an unexpected time word is correct; kRestart if it
///                    steps back and most of them continue from it
///   num_padding      returns the number of words, from the one at which check() stopped, that only fill up a frame
///   accept_time      advances the check past such a word
///   drop_word        updates the state when a word is dropped
///   forget           updates the state when an unknown number of words is missing
///   extrapolate      completes the state after a section of words to a guess of the state after `before` and all words
///                    up to there: the loops of the clock, and what the section has not set
///   is_synchronised  returns whether the state is complete
///   take_needed      notes what a word, which is decoded next, adds to an incomplete state
///   has_time         returns whether a time is known
///   decode           decodes checked words to events; returns the number of words used
///   decode_scalar    the scalar reference of decode()
///   skip_events      (optional) skips the words of a span of time and returns only their triggers
///   count_reports    (optional) sums the counts of the sensor in decoded words
///   time, time_loops return the time of the state in us, and how often the clock has wrapped around

}  // namespace e2lf::recordings
