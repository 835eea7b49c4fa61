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

/// What a live camera is set to before it starts. What is not given stays as the camera has it.
struct CameraSetup {
  /// Trigger inputs to switch on: "main", "aux", or the number that their triggers have; "none" = off. Empty = every
  /// input that the camera has.
  std::vector<std::string> trigger_channels = {};
  std::filesystem::path biases = {};              ///< a file of biases, as the vendor's programs write it (.bias)
  std::optional<uint32_t> max_events_per_s = {};  ///< of the event rate controller, which drops more; 0 = off
  std::vector<SensorRegion> regions = {};         ///< the pixels that send events; empty = all
  std::string encoding = {};                      ///< "evt2", "evt2.1", "evt3"
  bool operator==(const CameraSetup&) const = default;
};

}  // namespace e2lf::recordings
