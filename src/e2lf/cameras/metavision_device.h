// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <memory>
#include <metavision/hal/device/device.h>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cameras/cameras.h"

// The parts of metavision_camera.cpp. Only for builds that found the vendor's open HAL.
namespace e2lf::cameras {

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
