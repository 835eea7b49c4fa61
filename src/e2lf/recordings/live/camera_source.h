// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/live/camera.h"

namespace e2lf::recordings {

/// Number of bytes that may wait between a camera and its reader. Camera::keeps_unread() describes what happens to
/// more.
inline constexpr size_t kMaxWaitingBytes = size_t{1} << 26;

/// Applies the settings to a camera, and starts it and a thread that reads its bytes. The source ends with the camera,
/// and stops it when it is destroyed. If the camera fails after its first bytes, the source ends there with a warning,
/// and LiveBacklog::failure contains the reason. Fails as Camera::set_up() and Camera::start() do.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> start_camera_source(CameraPtr camera, std::string name,
                                                                      const CameraSetup& setup = {});

}  // namespace e2lf::recordings
