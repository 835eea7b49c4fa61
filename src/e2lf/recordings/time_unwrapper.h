// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace e2lf::recordings {

/// Computes full times from the low kBits bits in records. A forward step of less than a quarter of the range (with 32
/// bits, 17 minutes) may wrap the clock; a backward step of this size is a late event, possibly from before the wrap;
/// larger steps are damage. If kMaxOdd records in a row contradict this, they are correct: there was a pause, or the
/// step before them was the damage.
template <int kBits>
class TimeUnwrapper {
 public:
  TimeUnwrapper() = default;
  /// Continues after a record with this time.
  explicit TimeUnwrapper(int64_t t_us) : base_us_(t_us & ~kMask), last_us_(t_us & kMask), has_begun_(true) {}

  int64_t operator()(int64_t low_us) {
    if (!has_begun_) {
      has_begun_ = true;
      last_us_ = low_us;
    }
    const int64_t ahead_us = (low_us - last_us_) & kMask;
    if (ahead_us < kQuarter) [[likely]] {
      if (low_us < last_us_) base_us_ += kMask + 1;
      last_us_ = low_us;
      num_odd_ = 0;
      return base_us_ + low_us;
    }
    const bool is_before_wrap = ahead_us >= 3 * kQuarter && low_us > last_us_ && base_us_ > 0;
    const int64_t base_us = is_before_wrap ? base_us_ - kMask - 1 : base_us_;
    if (++num_odd_ == kMaxOdd) *this = TimeUnwrapper(base_us + low_us);
    return base_us + low_us;
  }

 private:
  static constexpr int64_t kMask = (int64_t{1} << kBits) - 1;
  static constexpr int64_t kQuarter = int64_t{1} << (kBits - 2);
  static constexpr int kMaxOdd = 16;
  int64_t base_us_ = 0, last_us_ = 0;
  int num_odd_ = 0;  ///< number of consecutive records that do not continue from last_us_
  bool has_begun_ = false;
};

}  // namespace e2lf::recordings
