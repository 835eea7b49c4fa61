// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/cli/flags/light_field_flags.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Reads one light field to make pictures of: all its views, in colour, values outside [0, 1] kept. Fails with
/// kUnsupported where `path` is something else; of a folder of cycles it says to name one of them. `disparities` (px
/// per view step) are what it shall be looked at with: kInvalidValue where one takes all of a view out of the picture.
[[nodiscard]] Result<lightfield::LightField> load_to_show(const std::filesystem::path& path,
                                                          const LightFieldFlags& flags, bool is_quiet,
                                                          const std::vector<float>& disparities = {});

/// The error of a verb that takes light fields alone.
[[nodiscard]] Error no_light_field_error(const std::filesystem::path& path);

}  // namespace e2lf::cli
