// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/cli/flags/light_field_flags.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Reads one light field for rendering: all its views, in colour, without clamping values to [0, 1]. Fails with
/// kUnsupported if `path` is something else; for a folder of cycles the error asks for one of them. Fails with
/// kInvalidValue if one of `disparities` (px per view step), at which it will be rendered, shifts a view out of the
/// image.
[[nodiscard]] Result<lightfield::LightField> load_to_show(const std::filesystem::path& path,
                                                          const LightFieldFlags& flags, bool is_quiet,
                                                          const std::vector<float>& disparities = {});

/// Returns the error of a verb that accepts only light fields.
[[nodiscard]] Error no_light_field_error(const std::filesystem::path& path);

}  // namespace e2lf::cli
