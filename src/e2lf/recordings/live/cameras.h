// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/recordings/live/camera.h"

// The plugins of the library; camera_registry.cpp contains their table.
namespace e2lf::recordings {

/// Opens a recording of any readable format and delivers it as EVT3 words at the times of its events, as a camera
/// would. A RAW recording in EVT3 is delivered byte for byte. Fails as open_recording() and parse_replay_address() do,
/// with kInvalidValue (the sensor is too large for EVT3), and with kUnsupported (another format is to be repeated).
[[nodiscard]] Result<CameraPtr> open_replay_camera(const std::string& address);

/// Opens the named pipe at `address`, or standard input if it is empty, and waits for the first byte. Fails with
/// kCancelled if a stop is requested before, and with kNotFound or kIo if it cannot be opened.
[[nodiscard]] Result<CameraPtr> open_pipe_camera(const std::string& address);

/// Connects to a sender at 127.0.0.1:PORT (numeric IPv4 address). Fails with kInvalidValue and kIo.
[[nodiscard]] Result<CameraPtr> open_tcp_camera(const std::string& address);

/// Creates a camera of a Linux driver (V4L2), which start() opens by its device ("video0" or "/dev/video0"), or the
/// first one that list_v4l2_cameras() finds if `address` is empty.
[[nodiscard]] Result<CameraPtr> open_v4l2_camera(const std::string& address);

/// Returns the devices in /dev that send events.
[[nodiscard]] Result<std::vector<std::string>> list_v4l2_cameras();

/// Creates a camera of Prophesee's open hardware layer (OpenEB's HAL), which start() opens by serial number or full
/// name, or the first one if `address` is empty. Only in builds that found the HAL. This code is tested with a
/// simulated HAL of the same interface, but has not been run with a camera.
[[nodiscard]] Result<CameraPtr> open_metavision_camera(const std::string& address);

/// Returns the full names of the cameras that the HAL finds. Fails with kIo.
[[nodiscard]] Result<std::vector<std::string>> list_metavision_cameras();

}  // namespace e2lf::recordings
