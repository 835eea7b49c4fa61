// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/capture/patterns/codes_header.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/files/npy.h"

namespace e2lf::capture {

/// Formats the sensor profile as a header line of a recording: the key "e2lf_camera", and the camera file as one line
/// of JSON.
[[nodiscard]] HeaderLines camera_to_header(const SensorProfile& camera);

/// Reads the sensor profile from the lines of a header. Returns nothing if there is none. Fails with kFormat and as
/// camera_from_json() does.
[[nodiscard]] Result<std::optional<SensorProfile>> camera_from_header(const HeaderLines& header,
                                                                      const std::string& location);

/// Returns the same JSON as an array of bytes, uint8 [length], which files of event images contain.
[[nodiscard]] NpyArray camera_to_npy(const SensorProfile& camera);

/// Reads a sensor profile from such an array. Fails with kShape (not a list of bytes), kFormat and as
/// camera_from_json() does.
[[nodiscard]] Result<SensorProfile> camera_from_npy(const NpyArray& array, const std::string& location);

/// The same functions for the orientation of the views: a header line "e2lf_views turned", and the name as an array of
/// bytes.
[[nodiscard]] HeaderLines views_to_header(const Orientation& views);
[[nodiscard]] Result<std::optional<Orientation>> views_from_header(const HeaderLines& header,
                                                                   const std::string& location);
[[nodiscard]] NpyArray views_to_npy(const Orientation& views);
[[nodiscard]] Result<Orientation> views_from_npy(const NpyArray& array, const std::string& location);

/// Returns a text as an array of bytes, and reads it back. Fails with kShape; `what` names the text in the message.
[[nodiscard]] NpyArray text_to_npy(const std::string& text);
[[nodiscard]] Result<std::string> text_from_npy(const NpyArray& array, const char* what, const std::string& location);

}  // namespace e2lf::capture
