// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/camera_setup.h"

namespace e2lf::cli {

/// The flags that set up a live camera; see recordings::CameraSetup.
struct CameraFlags {
  std::vector<std::string> trigger_channels, regions;
  std::filesystem::path biases;
  std::optional<uint32_t> max_events_per_s;
  std::string encoding;
};

void add_camera_options(CLI::App& app, CameraFlags& flags);

/// Returns the settings of a camera. Fails with kInvalidValue if a region is not of the form X,Y,WIDTH,HEIGHT.
[[nodiscard]] Result<recordings::CameraSetup> camera_setup(const CameraFlags& flags);

}  // namespace e2lf::cli
