// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "e2lf/recordings/live/camera.h"

struct e2lf_camera_functions;

// The cameras of the library, of which camera_registry.cpp contains the table, and how they are read.
namespace e2lf::recordings {

/// Number of bytes that may wait between a camera and its reader. Camera::keeps_unread() describes what happens to
/// more.
inline constexpr size_t kMaxWaitingBytes = size_t{1} << 26;

/// Applies the settings to a camera, and starts it and a thread that reads its bytes. The source ends with the camera,
/// and stops it when it is destroyed. If the camera fails after its first bytes, the source ends there with a warning,
/// and LiveBacklog::failure contains the reason. Fails as Camera::set_up() and Camera::start() do.
[[nodiscard]] Result<std::unique_ptr<LiveSource>> start_camera_source(CameraPtr camera, std::string name,
                                                                      const CameraSetup& setup = {});

/// Opens a recording of any readable format and delivers it as EVT3 words at the times of its events, as a camera
/// would. A RAW recording in EVT3 is delivered byte for byte. `address` is FILE or FILE?speed=S&repeat=N. Fails as
/// open_recording() does, with kInvalidValue (another key, a speed that is not above 0 and at most 1000, a number of
/// repeats that is not 1 to 1,000,000, or a sensor that is too large for EVT3), and with kUnsupported (another format
/// is to be repeated).
[[nodiscard]] Result<CameraPtr> open_replay_camera(const std::string& address);

/// Returns the length of the path at the beginning of such an address.
[[nodiscard]] size_t replay_path_size(const std::string& address);

/// Returns the path that the name of a camera contains: that of a replayed recording or of a named pipe. Returns an
/// empty path for all other cameras.
[[nodiscard]] std::filesystem::path path_of_camera(const std::string& name);

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

/// Returns the plugin with these functions, which must be valid until the process ends. Fails with kUnsupported
/// (another version) and kFormat (a missing function, or an invalid name).
[[nodiscard]] Result<CameraPlugin> plugin_of_functions(const e2lf_camera_functions* functions,
                                                       const std::string& location);

/// Loads plugins from files and folders, separated by colons; of a folder, all .so files in the order of their names.
/// Plugins that cannot be loaded are left out with a warning. Libraries stay loaded until the process ends.
[[nodiscard]] std::vector<CameraPlugin> load_camera_plugins(const std::string& places);

/// Creates a camera of Prophesee's open hardware layer (OpenEB's HAL), which start() opens by serial number or full
/// name, or the first one if `address` is empty. Only in builds that found the HAL. This code is tested with a
/// simulated HAL of the same interface, but has not been run with a camera.
[[nodiscard]] Result<CameraPtr> open_metavision_camera(const std::string& address);

/// Returns the full names of the cameras that the HAL finds. Fails with kIo.
[[nodiscard]] Result<std::vector<std::string>> list_metavision_cameras();

}  // namespace e2lf::recordings
