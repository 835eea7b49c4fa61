// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cli/output/run_record.h"

namespace e2lf::cli {

/// Where a camera is: a file, or a bundled one by its name. Fails with kNotFound.
[[nodiscard]] Result<std::filesystem::path> find_camera(const std::string& name);

/// Declares --camera: a camera file, or the name of a bundled one, before which a file of exactly this name goes.
void add_camera_option(CLI::App& app, std::string& camera, const std::string& help);

/// Reads what --camera names, and keeps it in the record. Fails with kNotFound, naming the bundled ones, and as
/// capture::read_camera().
[[nodiscard]] Result<capture::SensorProfile> load_camera(const std::string& name, RunRecord& record);

}  // namespace e2lf::cli
