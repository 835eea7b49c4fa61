// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/streams/stream_options.h"

namespace e2lf::cli {

/// A camera with one property changed, to see what that property costs.
struct CameraSetting {
  std::string name;
  capture::SensorProfile camera;       ///< what the network is told
  streams::PixelDefects defects = {};  ///< what it is not told
  double readout_events_per_s = 0;     ///< of a sensor of 1280x720 pixels; 0 = no limit
  int64_t rise_us = 0;                 ///< of the display
  size_t motion_px = 0;                ///< the scene moves to the left by so many pixels in a cycle
};

/// The camera itself, the camera without one of its imperfections, with one more, and an ideal one. Its event model
/// must be "pixel".
[[nodiscard]] std::vector<CameraSetting> camera_settings(const capture::SensorProfile& camera);

}  // namespace e2lf::cli
