// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace e2lf::recordings::dat {

/// Computes full times from the low 32 bits in records. A forward step of less than a quarter of the range (17 minutes)
/// may wrap the clock; a backward step of this size is a late event, possibly from before the wrap; larger steps are
/// damage. If kMaxOdd records in a row contradict this, they are correct: there was a pause, or the step before them
/// was the damage.
class TimeUnwrapper {
 public:
  TimeUnwrapper() = default;
  /// Continues after a record with this time.
  explicit TimeUnwrapper(int64_t t_us)
      : base_us_(t_us & ~int64_t{UINT32_MAX}), last_(static_cast<uint32_t>(t_us)), has_begun_(true) {}

  int64_t operator()(uint32_t low) {
    if (!has_begun_) {
      has_begun_ = true;
      last_ = low;
    }
    const uint32_t ahead = low - last_;
    if (ahead < kQuarter) [[likely]] {
      if (low < last_) base_us_ += kCircleUs;
      last_ = low;
      num_odd_ = 0;
      return base_us_ + low;
    }
    const bool is_before_wrap = ahead >= 3 * kQuarter && low > last_ && base_us_ > 0;
    const int64_t base_us = is_before_wrap ? base_us_ - kCircleUs : base_us_;
    if (++num_odd_ == kMaxOdd) *this = TimeUnwrapper(base_us + low);
    return base_us + low;
  }

 private:
  static constexpr uint32_t kQuarter = uint32_t{1} << 30;
  static constexpr int64_t kCircleUs = int64_t{1} << 32;
  static constexpr int kMaxOdd = 16;
  int64_t base_us_ = 0;
  uint32_t last_ = 0;
  int num_odd_ = 0;  ///< number of consecutive records that do not continue from last_
  bool has_begun_ = false;
};

}  // namespace e2lf::recordings::dat
