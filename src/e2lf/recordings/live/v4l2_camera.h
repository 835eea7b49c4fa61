// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/live/v4l2_device.h"

namespace e2lf::recordings {

/// Creates the camera of open_v4l2_camera() (cameras.h), whose devices are in `folder`. `system` must outlive it.
[[nodiscard]] CameraPtr make_v4l2_camera(V4l2System& system, const std::string& folder, const std::string& address);

}  // namespace e2lf::recordings
