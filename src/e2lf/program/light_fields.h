// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/program/inputs.h"

/// The light fields that verbs read, and the options of how they are read.
namespace e2lf::program {

/// The flags of verbs that read a light field.
struct LightFieldFlags {
  lightfield::ReadOptions read = {{.count = 0, .first = {}}, {}};  ///< views_y is for both axes; by default, all views
  OrientationFlags orientation = {};                               ///< replaces that of `read`
};

/// Declares --step, --white, --view-columns and --lenslet-views, and also --views if the verb can use any number of
/// views.
void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views);

[[nodiscard]] lightfield::ReadOptions read_options(const LightFieldFlags& flags);
/// The same for light fields that are shown or stored as they are: in colour, without clamping values to [0, 1].
[[nodiscard]] lightfield::ReadOptions unchanged_options(const LightFieldFlags& flags);

/// Reads a light field with read_light_field() and shows the progress.
[[nodiscard]] Result<lightfield::LightField> read_with_progress(const std::filesystem::path& path,
                                                                const lightfield::ReadOptions& options, bool is_quiet);

/// Options for reading a scene, which must have as many views as the patterns have cells.
struct SceneOptions {
  LightFieldFlags flags = {};       ///< the number of views in it is ignored
  size_t views_y = 8, views_x = 8;  ///< number of central views
  bool colour = false;              ///< whether to keep the colour; otherwise grey
};

/// Reads a light field of any supported format, with values in [0, 1]. Fails as read_light_field() does.
[[nodiscard]] Result<lightfield::LightField> load_scene(const std::filesystem::path& path, const SceneOptions& options,
                                                        bool is_quiet);

/// Reads one light field for rendering: all its views, in colour, without clamping values to [0, 1]. Fails with
/// kUnsupported if `path` is something else; for a folder of cycles the error asks for one of them. Fails with
/// kInvalidValue if one of `disparities` (px per view step), at which it will be rendered, shifts a view out of the
/// image.
[[nodiscard]] Result<lightfield::LightField> load_to_show(const std::filesystem::path& path,
                                                          const LightFieldFlags& flags, bool is_quiet,
                                                          const std::vector<float>& disparities = {});

}  // namespace e2lf::program
