// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/scene_input.h"

#include "e2lf/cli/flags/file_kind.h"
#include "e2lf/cli/flags/inputs.h"
#include "e2lf/sensor/coded_intensity.h"

namespace e2lf::cli {

Result<lightfield::LightField> load_scene(const std::filesystem::path& path, const SceneOptions& options,
                                          bool is_quiet) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  // A file of no other kind is taken for a recording; reading it gives a better error.
  if (kind != FileKind::kLightField && kind != FileKind::kRecording) {
    return other_kind_error(path, kind, "a light field");
  }
  lightfield::ReadOptions read = read_options(options.flags);
  read.views_y.count = options.views_y;
  read.views_x.count = options.views_x;
  read.colour = options.colour || options.filter;
  E2LF_ASSIGN_OR_RETURN(lightfield::LightField scene, read_with_progress(path, read, is_quiet));
  if (!options.filter) return scene;
  if (scene.shape().channels == 1) {
    return Error{ErrorCode::kInvalidValue, "the light field is grey; colour filters require one in colour",
                 path.string()};
  }
  return sensor::light_behind(*options.filter, scene);
}

}  // namespace e2lf::cli
