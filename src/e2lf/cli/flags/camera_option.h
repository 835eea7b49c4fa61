// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cli/output/run_record.h"

namespace e2lf::cli {

/// Returns the path of a camera file that is given by its path or by the name of a bundled camera. Fails with
/// kNotFound.
[[nodiscard]] Result<std::filesystem::path> find_camera(const std::string& name);

/// Declares --camera: a camera file or the name of a bundled camera. A file with exactly this name takes precedence.
void add_camera_option(CLI::App& app, std::string& camera, const std::string& help);

/// Reads the camera that --camera names and adds it to the record. Fails with kNotFound, listing the bundled cameras,
/// and as capture::read_camera() does.
[[nodiscard]] Result<capture::SensorProfile> load_camera(const std::string& name, RunRecord& record);

}  // namespace e2lf::cli
