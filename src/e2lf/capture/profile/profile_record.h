// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/capture/patterns/codes_header.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/files/npy.h"

namespace e2lf::capture {

/// The camera as a line of a recording's header, "e2lf_camera" and a camera file in one line of JSON.
[[nodiscard]] HeaderLines camera_to_header(const SensorProfile& camera);

/// The camera that a header names; nothing when it names none. Fails with kFormat and as camera_from_json() does.
[[nodiscard]] Result<std::optional<SensorProfile>> camera_from_header(const HeaderLines& header,
                                                                      const std::string& location);

/// The same JSON as an array of bytes, uint8 [length], as event images hold it.
[[nodiscard]] NpyArray camera_to_npy(const SensorProfile& camera);

/// Fails with kShape (no list of bytes), kFormat and as camera_from_json() does.
[[nodiscard]] Result<SensorProfile> camera_from_npy(const NpyArray& array, const std::string& location);

/// The same of how the views lie: a line "e2lf_views turned", the name as an array of bytes.
[[nodiscard]] HeaderLines views_to_header(const Orientation& views);
[[nodiscard]] Result<std::optional<Orientation>> views_from_header(const HeaderLines& header,
                                                                   const std::string& location);
[[nodiscard]] NpyArray views_to_npy(const Orientation& views);
[[nodiscard]] Result<Orientation> views_from_npy(const NpyArray& array, const std::string& location);

}  // namespace e2lf::capture
