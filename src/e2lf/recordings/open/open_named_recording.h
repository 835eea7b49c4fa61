// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// Whether a name stands for what is read as it arrives: "-", a camera, a named pipe, a device.
[[nodiscard]] bool is_live_recording(const std::string& name);

/// open_recording() of a file or of "-" for standard input; open_camera() of a camera's name (camera://NAME,
/// replay:FILE, tcp://ADDRESS:PORT); the same of a named pipe, and of standard input that is a pipe or socket.
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_named_recording(const std::string& name,
                                                                            const OpenOptions& options = {});

/// The bytes of what is_live_recording() names, as they come. Fails as open_camera_bytes() does, and with
/// kInvalidValue for a file.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> open_live_bytes(const std::string& name,
                                                                  const CameraSetup& setup = {});

}  // namespace e2lf::recordings
