// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/live/camera.h"

namespace e2lf::recordings {

/// Number of bytes that may wait between a camera and its reader. If more are waiting, the camera is not read; see
/// Camera::keeps_unread().
inline constexpr size_t kMaxWaitingBytes = size_t{1} << 26;

/// Starts a camera and a thread that reads its bytes. The source ends with the camera, and stops it when it is
/// destroyed. Fails as Camera::start() does.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> start_camera_source(std::unique_ptr<Camera> camera, std::string name);

}  // namespace e2lf::recordings
