// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/live/camera.h"

namespace e2lf::recordings {

/// Bytes that may wait between a camera and its reader; what happens to more of them says Camera::keeps_unread().
inline constexpr size_t kMaxWaitingBytes = size_t{1} << 26;

/// Sets up and starts a camera and the thread that takes its bytes. The source ends when the camera does, and stops it
/// when it is destroyed. A camera that fails after its first bytes ends the source, with a warning;
/// LiveBacklog::failure then says why. Fails as Camera::set_up() and start() do.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> start_camera_source(std::unique_ptr<Camera> camera, std::string name,
                                                                      const CameraSetup& setup = {});

}  // namespace e2lf::recordings
