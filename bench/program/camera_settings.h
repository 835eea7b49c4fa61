// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/streams/stream_options.h"

namespace e2lf::bench {

/// A camera with one property changed, to measure the influence of this property.
struct CameraSetting {
  std::string name;
  capture::SensorProfile camera;       ///< the sensor profile that the network receives
  streams::PixelDefects defects = {};  ///< defects that are unknown to the network
  double readout_events_per_s = 0;     ///< for a sensor of 1280x720 pixels; 0 = no limit
  int64_t rise_us = 0;                 ///< rise time of the display
  size_t motion_px = 0;                ///< motion of the scene to the left per cycle
};

/// Returns the camera itself, the camera without one of its imperfections or with an additional one, and an ideal
/// camera. The event model of `camera` must be "pixel".
[[nodiscard]] std::vector<CameraSetting> camera_settings(const capture::SensorProfile& camera);

}  // namespace e2lf::bench
