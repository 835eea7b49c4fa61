// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/orientation.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// Reorders the views in place according to capture::Orientation. Applying it twice restores the order. With kTurned,
/// every disparity changes its sign.
void orient(LightField& light_field, const capture::Orientation& orientation);

/// Returns the note "views" for the run record of a reconstruction: the orientation of the capture's views, and the
/// orientation in which the files still store them.
[[nodiscard]] Json views_note(const capture::Orientation& capture, const capture::Orientation& stored);

/// Returns the orientation that still has to be applied to the stored views, according to the note "views" in the
/// run.json of the folder. It is upright if there is no note. `path` is the folder or the lightfield.npy in it. Fails
/// with kInvalidValue if the note is not an orientation.
[[nodiscard]] Result<capture::Orientation> stored_orientation(const std::filesystem::path& path);

}  // namespace e2lf::lightfield
