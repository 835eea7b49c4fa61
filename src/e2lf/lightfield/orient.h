// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/orientation.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// Lets the views change places as capture::Orientation says, in place; doing it again undoes it. With kTurned every
/// disparity changes its sign.
void orient(LightField& light_field, const capture::Orientation& orientation);

/// The note "views" of the run record of a reconstruction: how those of the capture come out, and how those in the
/// files still lie.
[[nodiscard]] Json views_note(const capture::Orientation& capture, const capture::Orientation& stored);

/// How the views in the files of a light field still lie by the note "views" of its folder's run.json; upright where
/// there is none. `path` is the folder or the lightfield.npy in it. Fails with kInvalidValue (a note of another kind).
[[nodiscard]] Result<capture::Orientation> stored_orientation(const std::filesystem::path& path);

}  // namespace e2lf::lightfield
