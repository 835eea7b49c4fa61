// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/files/npy.h"

namespace e2lf::capture {

/// The setup with which measurements were recorded, as far as it is known.
struct RecordedSetup {
  std::optional<Codes> codes = {};
  std::optional<SensorProfile> camera = {};
  std::optional<Orientation> views = {};  ///< orientation of the views: its own, or that of the camera
  std::string findings = {};  ///< what may be wrong with the rig: diagnose::to_json() as text; empty = unknown

  /// Returns true if the orientation is known and is not that of the camera.
  [[nodiscard]] bool has_own_views() const { return views && !(camera && camera->views == views); }
};

/// Formats the setup as header lines of a recording: the patterns (codes_to_header()), "e2lf_camera" with the camera
/// file as one line of JSON, and "e2lf_views turned" if the camera does not state them.
[[nodiscard]] HeaderLines setup_to_header(const RecordedSetup& setup);

/// Returns the setup that the lines of a header state. Fails as codes_from_header(), camera_from_json() and
/// orientation_from_name() do; `location` is the file.
[[nodiscard]] Result<RecordedSetup> setup_from_header(const HeaderLines& header, const std::string& location);

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
