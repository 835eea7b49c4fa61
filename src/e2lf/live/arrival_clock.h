// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

namespace e2lf::live {

using Clock = std::chrono::steady_clock;

/// Tells when an event arrived at this host from its time on the sensor's clock. Bytes arrive in pieces and wait to be
/// decoded, so that only the least delay of the last kWindow tells how both clocks relate; it follows their drift.
class ArrivalClock {
 public:
  static constexpr std::chrono::seconds kWindow{5};

  /// Adds bytes that came at `arrival`; the newest event in them is of t_us.
  void add(Clock::time_point arrival, int64_t t_us) {
    const int64_t offset_us =
        std::chrono::duration_cast<std::chrono::microseconds>(arrival.time_since_epoch()).count() - t_us;
    if (arrival - begin_ >= kWindow) {
      before_us_ = least_us_;
      least_us_ = kUnknown;
      begin_ = arrival;
    }
    least_us_ = std::min(least_us_, offset_us);
  }

  /// Returns when an event of t_us arrived. add() must have been called.
  [[nodiscard]] Clock::time_point arrival_of(int64_t t_us) const {
    return Clock::time_point(std::chrono::microseconds(std::min(least_us_, before_us_) + t_us));
  }

 private:
  static constexpr int64_t kUnknown = std::numeric_limits<int64_t>::max() / 2;
  Clock::time_point begin_{};
  int64_t least_us_ = kUnknown, before_us_ = kUnknown;
};

}  // namespace e2lf::live
