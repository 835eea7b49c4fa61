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

/// Adds the setup to the arrays of a file: `codes` [N, view_y, view_x], `camera` (see camera_to_npy()) and, if the
/// camera does not state them, `views` (see views_to_npy()), and `findings` as bytes.
void setup_to_arrays(const RecordedSetup& setup, NpzArrays& arrays);

/// Returns the setup that the arrays of a file hold. Fails as codes_from_npy(), camera_from_npy() and views_from_npy()
/// do; `location` is the file.
[[nodiscard]] Result<RecordedSetup> setup_from_arrays(const NpzArrays& arrays, const std::string& location);

}  // namespace e2lf::capture
