// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/colour_filter.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cli/flags/light_field_flags.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// What is wanted of a scene beside the flags for its file: as many views as patterns have cells, and its colours.
struct SceneOptions {
  LightFieldFlags flags = {};                        ///< their number of views counts for nothing
  size_t views_y = 8, views_x = 8;                   ///< the middle ones
  bool colour = false;                               ///< keep it; otherwise grey
  std::optional<capture::ColourFilter> filter = {};  ///< the light is what a sensor with these filters sees
};

/// Reads a light field of any supported format in [0, 1]. Fails as read_light_field() does, and with kInvalidValue
/// where filters need colour that is not there.
[[nodiscard]] Result<lightfield::LightField> load_scene(const std::filesystem::path& path, const SceneOptions& options,
                                                        bool is_quiet);

}  // namespace e2lf::cli
