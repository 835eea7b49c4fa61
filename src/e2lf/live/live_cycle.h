// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/live/pace.h"

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

/// A pattern cycle as the camera delivered it.
struct LiveCycle {
  capture::Measurement counts;  ///< event images, summed over the last `cycles` cycles
  size_t cycles = 1;
  uint64_t number = 0;  ///< number of the cycle in the recording
  int64_t begin_us = 0, end_us = 0;
  uint64_t events = 0;
  float confidence = 1;
  double cycle_s = 0;              ///< time from the previous cycle to this one; 0 = unknown
  Clock::time_point last_event{};  ///< arrival of its last event at this host
};

/// The parameters for rendering a light field. Viewpoints are in view steps from the centre of the grid, as in the
/// viewer.
struct RenderSettings {
  float x = 0.5F, y = 0.5F;  ///< viewpoint, to the right and downwards; by default one of the four central views
  float focus = 0;           ///< disparity of the plane in focus, in px of the full resolution per view step
  float radius = 0;          ///< radius of the round aperture, in view steps; 0 = only the viewpoint
  std::optional<uint32_t> row = {}, column = {};  ///< EPIs to cut, in px of the full resolution; empty = none
  bool operator==(const RenderSettings&) const = default;
};

/// The light field of a cycle.
struct LiveField {
  lightfield::LightField light_field;  ///< upright, as computed by the network; see `black` and `gain`
  std::vector<size_t> views;           ///< numbers of the views that are set, in order; empty = all
  RenderSettings settings;             ///< the parameters that determined the views
  LiveCycle cycle;                     ///< always in full resolution
  QualityLevel level;
  float black = 0, gain = 1;  ///< displayed values are gain * (value - black)
  double reconstruct_s = 0;
  uint64_t serial = 0;  ///< counts the light fields from 1

  /// Returns a copy without the light field.
  [[nodiscard]] LiveField without_views() const {
    return {{}, {}, settings, cycle, level, black, gain, reconstruct_s, serial};
  }

  /// Sets all views by make(*this). If this fails, those of `views` are still the only ones that are set.
  template <typename Make>
  Result<void> complete(const Make& make) {
    const std::vector<size_t> set = std::exchange(views, {});
    Result<void> made = make(*this);
    if (!made) views = set;
    return made;
  }
};

}  // namespace e2lf::live
