// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/live/camera.h"

namespace Metavision {
class Device;
}

namespace e2lf::cameras {

/// Registers the cameras of this library with recordings::add_camera_plugin(), as a program does with its own: replayed
/// recordings, pipes, TCP, the vendor's HAL if the build has it, and the plugins in the environment variable
/// E2LF_CAMERA_PLUGINS. Further calls do nothing.
void add_cameras();

using namespace recordings;

// The functions that cameras.cpp registers.

/// Opens a recording of any readable format and delivers it as EVT3 words at the times of its events, as a camera
/// would. A RAW recording in EVT3 is delivered byte for byte. `address` is FILE or FILE?speed=S&repeat=N. Fails as
/// open_recording() does, with kInvalidValue (another key, a speed that is not above 0 and at most 1000, a number of
/// repeats that is not 1 to 1,000,000, or a sensor that is too large for EVT3), and with kUnsupported (another format
/// is to be repeated).
[[nodiscard]] Result<CameraPtr> open_replay_camera(const std::string& address);

/// Returns the speed at which `input` is replayed; 1 if it is no replay, or one that cannot be opened.
[[nodiscard]] double replay_speed(const std::string& input);

/// Opens the named pipe at `address`, or standard input if it is empty, and waits for the first byte. Fails with
/// kCancelled if a stop is requested before, and with kNotFound or kIo if it cannot be opened.
[[nodiscard]] Result<CameraPtr> open_pipe_camera(const std::string& address);

/// Connects to a sender at 127.0.0.1:PORT (numeric IPv4 address). Fails with kInvalidValue and kIo.
[[nodiscard]] Result<CameraPtr> open_tcp_camera(const std::string& address);

/// Creates a camera of Prophesee's open hardware layer (OpenEB's HAL), which start() opens by serial number or full
/// name, or the first one if `address` is empty. Only in builds that found the HAL. This code is tested with a
/// simulated HAL of the same interface, but has not been run with a camera.
[[nodiscard]] Result<CameraPtr> open_metavision_camera(const std::string& address);

/// Returns the full names of the cameras that the HAL finds. Fails with kIo.
[[nodiscard]] Result<std::vector<std::string>> list_metavision_cameras();

/// Returns the reason why no camera could be opened, which the HAL does not report, and what to check. `address` is the
/// requested camera, empty = any; `listed` contains the cameras that the HAL lists.
[[nodiscard]] Error unopened_error(const std::string& address, const std::vector<std::string>& listed);

// The parts of open_metavision_camera(), in builds that found the HAL.

/// Returns the message of an exception of the HAL, which has several lines, in one.
[[nodiscard]] std::string hal_text(const std::exception& error);

/// Opens a camera by serial number or full name, or the first one, and selects its encoding. Fails with kNotFound, kIo
/// (busy, or permission denied) and kUnsupported (it does not support the encoding, or none that can be read).
[[nodiscard]] Result<std::unique_ptr<Metavision::Device>> open_device(const std::string& address,
                                                                      const std::string& encoding);

/// Applies the settings to a camera that has not started. Exceptions of the HAL propagate. Fails with kUnsupported (the
/// camera lacks a requested feature), kInvalidValue (it refuses a value) and kNotFound (the file of biases is missing).
[[nodiscard]] Result<void> set_up_device(Metavision::Device& device, const CameraSetup& setup);

/// Returns the header of a RAW recording: the properties of the sensor, and the settings as read back from the camera:
/// trigger_channels, biases, max_events_per_s, regions, anti_flicker, event_trail_filter.
[[nodiscard]] std::string device_header(Metavision::Device& device);

/// Returns the biases, the limit of the event rate and the regions that the camera has; see Camera::controls().
[[nodiscard]] std::vector<CameraControl> device_controls(Metavision::Device& device);

/// Changes one of them. Exceptions of the HAL propagate. Fails as Camera::change() does.
[[nodiscard]] Result<void> change_device(Metavision::Device& device, const std::string& name, const std::string& value);

/// Returns the text of a .bias file, or an empty string for a camera without biases.
[[nodiscard]] std::string device_biases(Metavision::Device& device);

}  // namespace e2lf::cameras
