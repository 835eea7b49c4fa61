// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
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

/// The same functions for the orientation of the views: a header line "e2lf_views turned".
[[nodiscard]] HeaderLines views_to_header(const Orientation& views);
[[nodiscard]] Result<std::optional<Orientation>> views_from_header(const HeaderLines& header,
                                                                   const std::string& location);

/// The setup with which measurements were recorded, as far as it is known.
struct RecordedSetup {
  std::optional<Codes> codes = {};
  std::optional<SensorProfile> camera = {};
  std::optional<Orientation> views = {};  ///< orientation of the views: its own, or that of the camera
  std::string findings = {};  ///< what may be wrong with the rig: diagnose::to_json() as text; empty = unknown

  /// Returns true if the orientation is known and is not that of the camera.
  [[nodiscard]] bool has_own_views() const { return views && !(camera && camera->views == views); }
};

/// Adds the setup to the arrays of a file: `codes` [N, view_y, view_x], and as bytes of text (see text_to_npy())
/// `camera`, the camera file as one line of JSON, `views` if the camera does not state them, and `findings`.
void setup_to_arrays(const RecordedSetup& setup, NpzArrays& arrays);

/// Returns the setup that the arrays of a file hold. Fails with kShape (not a list of bytes), and as codes_from_npy(),
/// camera_from_json() and orientation_from_name() do; `location` is the file.
[[nodiscard]] Result<RecordedSetup> setup_from_arrays(const NpzArrays& arrays, const std::string& location);

/// Returns a text as an array of bytes, and reads it back. Fails with kShape; `what` names the text in the message.
[[nodiscard]] NpyArray text_to_npy(const std::string& text);
[[nodiscard]] Result<std::string> text_from_npy(const NpyArray& array, const char* what, const std::string& location);

}  // namespace e2lf::capture
