// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::live {
using Clock = std::chrono::steady_clock;

/// Converts times of the sensor's clock to arrival times at this host. Most bytes arrive late, because they are sent in
/// pieces and wait to be decoded. The offset between the clocks is therefore that of the least delayed bytes within the
/// last kWindow, which also follows the drift of the clocks.
class ArrivalClock {
 public:
  static constexpr std::chrono::seconds kWindow{5};

  /// `speed` is that of the sensor's clock: above 1 for a recording that is replayed faster than it was recorded.
  explicit ArrivalClock(double speed = 1) : speed_(speed) {}

  /// Adds bytes that arrived at `arrival` and whose newest event has the time t_us.
  void add(Clock::time_point arrival, int64_t t_us) {
    const int64_t offset_us =
        std::chrono::duration_cast<std::chrono::microseconds>(arrival.time_since_epoch()).count() - host_us(t_us);
    if (arrival - begin_ >= kWindow) {
      before_us_ = least_us_;
      least_us_ = kUnknown;
      begin_ = arrival;
    }
    least_us_ = std::min(least_us_, offset_us);
  }

  /// Returns when an event with the time t_us arrived. add() must have been called before.
  [[nodiscard]] Clock::time_point arrival_of(int64_t t_us) const {
    return Clock::time_point(std::chrono::microseconds(std::min(least_us_, before_us_) + host_us(t_us)));
  }

 private:
  [[nodiscard]] int64_t host_us(int64_t t_us) const {
    return speed_ == 1 ? t_us : std::llround(static_cast<double>(t_us) / speed_);
  }

  static constexpr int64_t kUnknown = std::numeric_limits<int64_t>::max() / 2;
  double speed_;
  Clock::time_point begin_{};
  int64_t least_us_ = kUnknown, before_us_ = kUnknown;
};

/// A pattern cycle as the camera delivered it.
struct LiveCycle : cycles::Cycle {
  size_t cycles = 1;               ///< the number of cycles, of which it is the last one, that `images` sums
  capture::FusedCycles fused;      ///< `images`, fused with those of the cycles before; empty if they are not
  double fused_cycles = 0;         ///< mean of the number of cycles over the pixels of `fused`
  double cycle_s = 0;              ///< time from the previous cycle to this one; 0 = unknown
  Clock::time_point last_event{};  ///< arrival of its last event at this host
};

/// Computes event images of a lower resolution: each count is the sum over a block of side x side pixels (2 or 4),
/// limited to the range of int16. Odd last rows and columns are left out. `sums` is resized if its shape differs,
/// otherwise its memory is used again. A network takes the sums as those of side^2 cycles of one pixel. Images that are
/// smaller than a block break the contract.
void sum_blocks(const capture::EventImages& images, size_t side, capture::EventImages& sums);

/// Computes fused cycles of a lower resolution: each count is the mean over a block, and the number of cycles is that
/// of as many independent cycles of one pixel. The arguments are as above.
void fuse_blocks(const capture::FusedCycles& fused, size_t side, capture::FusedCycles& blocks);

/// Maximum number of cycles of a static scene that are summed.
inline constexpr size_t kMostCycles = 16;

/// Sums the event images of the last cycles of a static scene. Memory is bounded by kMostCycles cycles.
class CycleSum {
 public:
  /// Adds the images of a cycle and replaces them by the sum over the last `wanted` cycles (1 to kMostCycles), or over
  /// all cycles if fewer were added. Returns the number of cycles in the sum. Sums saturate at the range of int16.
  /// Images whose shape differs from that of the previous ones start a new sum.
  size_t add(capture::EventImages& images, size_t wanted);

 private:
  std::deque<capture::EventImages> last_;
  std::vector<int32_t> sum_;
};

/// Returns a light field whose pixels are repeated to blocks until it has this size, of which its own size is a part:
/// the inverse of sum_blocks(). The last pixels also fill a rest.
[[nodiscard]] lightfield::LightField enlarged(const lightfield::LightField& light_field, size_t height, size_t width);

}  // namespace e2lf::live
