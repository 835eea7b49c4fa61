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

/// Options for reading a scene, which must have as many views as the patterns have cells.
struct SceneOptions {
  LightFieldFlags flags = {};                        ///< the number of views in it is ignored
  size_t views_y = 8, views_x = 8;                   ///< number of central views
  bool colour = false;                               ///< whether to keep the colour; otherwise grey
  std::optional<capture::ColourFilter> filter = {};  ///< if set, the scene as a sensor with these filters receives it
};

/// Reads a light field of any supported format, with values in [0, 1]. Fails as read_light_field() does, and with
/// kInvalidValue if filters require colour and the light field has none.
[[nodiscard]] Result<lightfield::LightField> load_scene(const std::filesystem::path& path, const SceneOptions& options,
                                                        bool is_quiet);

}  // namespace e2lf::cli
