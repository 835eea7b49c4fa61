// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/live/camera_plugin.h"

namespace e2lf::recordings {

/// Returns the plugin of functions that stay valid until the process ends. Fails with kUnsupported (another version)
/// and kFormat (a function is missing, or the name is none).
[[nodiscard]] Result<CameraPlugin> plugin_of_functions(const e2lf_camera_functions* functions,
                                                       const std::string& location);

/// Loads plugins from files and folders (all of their .so files, in the order of their names) that are separated by
/// colons. What cannot be loaded is left out with a warning. Libraries stay loaded until the process ends.
[[nodiscard]] std::vector<CameraPlugin> load_camera_plugins(const std::string& places);

}  // namespace e2lf::recordings
