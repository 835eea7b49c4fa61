// SPDX-License-Identifier: MIT
#include "e2lf/program/light_fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/program/option_values.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::program {
namespace fs = std::filesystem;
using info::file_kind, info::FileKind, info::other_kind_error;

void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views) {
  const OptionGroup group(app, kLightFieldOptions);
  if (has_views) {
    app.add_option("--views", flags.read.views_y.count, "number of central views to read per axis; 0 = all")
        ->check(whole_number(0, 65535));
  }
  app.add_option("--step", flags.read.views_y.step, "read every N-th view, which multiplies the disparity by N")
      ->check(whole_number(1, 65535));
  app.add_option("--white", flags.read.white, "stored value that is white, e.g. 255; default: the largest of the type")
      ->check(positive_number());
  app.add_option("--view-columns", flags.read.view_columns,
                 "number of views in a row of the grid, if views are numbered consecutively (input_Cam000.png ...); "
                 "default: detected")
      ->check(whole_number(1, 10000));
  app.add_option(
         "--lenslet-views", flags.read.lenslet_views,
         "number of views per axis in one picture that holds all views: a lenslet mosaic, or an Hr_SAI_y patch; "
         "default: as its name or content states")
      ->check(whole_number(1, 1000));
}

lightfield::ReadOptions read_options(const LightFieldFlags& flags) {
  lightfield::ReadOptions options = flags.read;
  options.views_x = options.views_y;
  options.orientation = flags.orientation.value();
  return options;
}

lightfield::ReadOptions unchanged_options(const LightFieldFlags& flags) {
  lightfield::ReadOptions options = read_options(flags);
  options.colour = true;
  options.range = lightfield::RangePolicy::kKeep;
  return options;
}

Result<lightfield::LightField> read_with_progress(const fs::path& path, const lightfield::ReadOptions& options,
                                                  bool is_quiet) {
  ProgressBar bar("read " + path.filename().string(), is_quiet);
  bar.update(0, 1);
  return lightfield::read_light_field(path, options, bar.callback());
}

Result<lightfield::LightField> load_scene(const fs::path& path, const SceneOptions& options, bool is_quiet) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  // A file of no other kind is taken for a recording; reading it gives a better error.
  if (kind != FileKind::kLightField && kind != FileKind::kRecording) {
    return other_kind_error(path, kind, "a light field");
  }
  lightfield::ReadOptions read = read_options(options.flags);
  read.views_y.count = options.views_y;
  read.views_x.count = options.views_x;
  read.colour = options.colour;
  return read_with_progress(path, read, is_quiet);
}

Result<lightfield::LightField> load_to_show(const fs::path& path, const LightFieldFlags& flags, bool is_quiet,
                                            const std::vector<float>& disparities) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  if (kind != FileKind::kLightField) return other_kind_error(path, kind, "a light field");
  E2LF_ASSIGN_OR_RETURN(lightfield::LightField light_field,
                        read_with_progress(path, unchanged_options(flags), is_quiet));
  const auto [width, height] = std::pair(light_field.shape().width, light_field.shape().height);
  for (const float disparity : disparities) {
    if (std::abs(disparity) < static_cast<float>(std::max(width, height))) continue;
    return fail(ErrorCode::kInvalidValue, path, "a disparity of ", disparity, " px per view step exceeds the image of ",
                width, "x", height, " px; use a disparity closer to 0");
  }
  return light_field;
}

}  // namespace e2lf::program
