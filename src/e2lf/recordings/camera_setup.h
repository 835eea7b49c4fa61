// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace e2lf::recordings {

/// A rectangle of the sensor, in pixels from its upper left corner.
struct SensorRegion {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const SensorRegion&) const = default;
};

/// The settings that are applied to a live camera before it starts. Empty settings are left as the camera has them.
struct CameraSetup {
  /// Trigger inputs to enable: "main", "aux", or the number of their triggers; "none" disables all. Empty = all inputs
  /// of the camera.
  std::vector<std::string> trigger_channels = {};
  std::filesystem::path biases = {};              ///< a file of biases, as written by the vendor's programs (.bias)
  std::optional<uint32_t> max_events_per_s = {};  ///< limit of the event rate controller, which drops events; 0 = off
  std::vector<SensorRegion> regions = {};         ///< the pixels that send events; empty = all
  std::string encoding = {};                      ///< "evt2", "evt2.1", "evt3"
  bool switches_filters_off = false;  ///< the anti-flicker and event trail filters of the sensor, which drop events
  bool operator==(const CameraSetup&) const = default;
};

}  // namespace e2lf::recordings
