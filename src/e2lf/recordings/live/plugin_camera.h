// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/live/camera_plugin.h"

namespace e2lf::recordings {

/// Returns the plugin with these functions, which must be valid until the process ends. Fails with kUnsupported
/// (another version) and kFormat (a missing function, or an invalid name).
[[nodiscard]] Result<CameraPlugin> plugin_of_functions(const e2lf_camera_functions* functions,
                                                       const std::string& location);

/// Loads plugins from files and folders, separated by colons; of a folder, all .so files in the order of their names.
/// Plugins that cannot be loaded are left out with a warning. Libraries stay loaded until the process ends.
[[nodiscard]] std::vector<CameraPlugin> load_camera_plugins(const std::string& places);

}  // namespace e2lf::recordings
