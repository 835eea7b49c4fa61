// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>

#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings::timed {

/// Generates the TIME_HIGH words of EVT2 and EVT2.1: one at every step, and a repetition after 16 us.
class Clock {
 public:
  /// Calls put(head) with the TIME_HIGH heads that must precede an event at `t_us`.
  template <typename Put>
  void advance(int64_t t_us, const Put& put) {
    const int64_t high = t_us >> 6;
    if (high == high_ && t_us - written_us_ < kHeartbeatUs) return;
    int64_t from = high;
    if (high_ < 0) {
      // A recording that begins beyond the 34-bit clock first counts its loops.
      for (int64_t step = kMaxStep; step < high && high > kTimeHighMask; step += kMaxStep) put(head(step));
    } else if (high > high_ && high - high_ <= kMaxFilled) {
      from = high_ + 1;
    } else if (high > high_) {
      for (int64_t step = high_ + kMaxStep; step < high; step += kMaxStep) put(head(step));
    }
    for (int64_t step = from; step <= high; ++step) put(head(step));
    high_ = high;
    written_us_ = t_us;
  }

  /// Later starts would need too many words.
  static constexpr int64_t kMaxFirstUs = int64_t{1} << 52;

 private:
  static constexpr int64_t kHeartbeatUs = 16;
  static constexpr int64_t kMaxStep = int64_t{1} << 25;   ///< a quarter of what would be read as a step back
  static constexpr int64_t kMaxFilled = 10'000'000 / 64;  ///< pauses of up to 10 s are filled step by step

  static uint32_t head(int64_t high) {
    return (static_cast<uint32_t>(kTimeHigh) << 28) | (static_cast<uint32_t>(high) & kTimeHighMask);
  }

  int64_t high_ = -1;
  int64_t written_us_ = 0;
};

inline uint32_t event_head(uint32_t p, int64_t t_us, uint32_t x, uint32_t y) {
  return ((p & 1u) << 28) | (static_cast<uint32_t>(t_us & 0x3F) << 22) | (x << 11) | y;
}

inline uint32_t trigger_head(const Trigger& trigger) {
  return (static_cast<uint32_t>(kTrigger) << 28) | (static_cast<uint32_t>(trigger.t & 0x3F) << 22) |
         (static_cast<uint32_t>(trigger.id & 0x1F) << 8) | (trigger.p & 1u);
}

}  // namespace e2lf::recordings::timed
