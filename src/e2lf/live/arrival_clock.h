// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

namespace e2lf::live {

using Clock = std::chrono::steady_clock;

/// Converts times of the sensor's clock to arrival times at this host. Most bytes arrive late, because they are sent in
/// pieces and wait to be decoded. The offset between the clocks is therefore that of the least delayed bytes within the
/// last kWindow, which also follows the drift of the clocks.
class ArrivalClock {
 public:
  static constexpr std::chrono::seconds kWindow{5};

  /// Adds bytes that arrived at `arrival` and whose newest event has the time t_us.
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

  /// Returns when an event with the time t_us arrived. add() must have been called before.
  [[nodiscard]] Clock::time_point arrival_of(int64_t t_us) const {
    return Clock::time_point(std::chrono::microseconds(std::min(least_us_, before_us_) + t_us));
  }

 private:
  static constexpr int64_t kUnknown = std::numeric_limits<int64_t>::max() / 2;
  Clock::time_point begin_{};
  int64_t least_us_ = kUnknown, before_us_ = kUnknown;
};

}  // namespace e2lf::live
