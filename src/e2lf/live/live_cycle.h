// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/polarity_check.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/live/arrival_clock.h"
#include "e2lf/live/pace.h"

namespace e2lf::live {

/// A pattern cycle as it came from the camera.
struct LiveCycle {
  capture::Measurement counts;  ///< its event images, or their sums over the last `cycles` cycles
  size_t cycles = 1;
  uint64_t number = 0;  ///< in the recording
  int64_t begin_us = 0, end_us = 0;
  uint64_t events = 0;
  float confidence = 1;
  cycles::CyclePolarity polarity = cycles::CyclePolarity::kUnknown;
  double cycle_s = 0;              ///< time from the previous cycle to this one; 0 = not known
  Clock::time_point last_event{};  ///< when its last event arrived at this host
};

/// How a light field is looked at. Viewpoints are in view steps from the middle of the grid, as those of the viewer.
struct Look {
  float x = 0.5F, y = 0.5F;  ///< viewpoint, to the right and downwards; a view of the 8x8 grid
  float focus = 0;           ///< disparity of the plane in focus, px per view step of the full size
  float radius = 0;          ///< of the round aperture, in view steps; 0 = the viewpoint alone
  std::optional<uint32_t> row = {}, column = {};  ///< px of the full size where EPIs are cut; none without
  bool operator==(const Look&) const = default;
};

/// The light field of a cycle.
struct LiveField {
  lightfield::LightField light_field;  ///< the network's values, upright; see `black` and `gain`
  std::vector<size_t> views;           ///< numbers of those that are set, in order; none = all
  Look look;                           ///< that it was made for, and which it has the views of
  LiveCycle cycle;                     ///< in full size
  Gait gait;
  float black = 0, gain = 1;  ///< what is seen is gain * (value - black)
  double reconstruct_s = 0;
  uint64_t serial = 0;  ///< counts the light fields from 1
};

}  // namespace e2lf::live
