// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/recordings/live/camera.h"

// The plugins that come with the library; see the table in camera_registry.cpp.
namespace e2lf::recordings {

/// A recording of any format that we read, delivered as EVT3 words when its events are due: what a camera would do. A
/// RAW recording in EVT3 is delivered byte for byte. Fails as open_recording() does, and with kInvalidValue for a
/// sensor that EVT3 cannot hold.
[[nodiscard]] Result<std::unique_ptr<Camera>> open_replay_camera(const std::string& path);

/// What comes through the named pipe at `address`, or through standard input where it is empty. Waits for the first
/// byte; fails with kCancelled when a stop is asked for before, and with kNotFound or kIo when it cannot be opened.
[[nodiscard]] Result<std::unique_ptr<Camera>> open_pipe_camera(const std::string& address);

/// A sender at 127.0.0.1:PORT (numeric IPv4 address). Fails with kInvalidValue and kIo.
[[nodiscard]] Result<std::unique_ptr<Camera>> open_tcp_camera(const std::string& address);

/// A camera of Prophesee's open hardware layer (OpenEB's HAL), by serial number, or the first. Only in builds that
/// found it. It compiles against the HAL's headers and has not been run with a camera.
[[nodiscard]] Result<std::unique_ptr<Camera>> open_metavision_camera(const std::string& serial);

}  // namespace e2lf::recordings
