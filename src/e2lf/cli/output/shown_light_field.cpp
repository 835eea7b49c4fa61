// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/shown_light_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/file_kind.h"
#include "e2lf/cli/flags/inputs.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

Error no_light_field_error(const fs::path& path) {
  const auto kind = file_kind(path);
  if (!kind) return kind.error();
  return other_kind_error(path, *kind, "a light field");
}

Result<lightfield::LightField> load_to_show(const fs::path& path, const LightFieldFlags& flags, bool is_quiet,
                                            const std::vector<float>& disparities) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(path));
  if (kind != FileKind::kLightField) return no_light_field_error(path);
  lightfield::ReadOptions options = read_options(flags);
  options.colour = true;
  options.range = lightfield::RangePolicy::kKeep;
  E2LF_ASSIGN_OR_RETURN(lightfield::LightField light_field, read_with_progress(path, options, is_quiet));
  const auto [width, height] = std::pair(light_field.shape().width, light_field.shape().height);
  for (const float disparity : disparities) {
    if (std::abs(disparity) < static_cast<float>(std::max(width, height))) continue;
    return Error{ErrorCode::kInvalidValue,
                 cat("a disparity of ", disparity, " px per view step leaves the picture of ", width, "x", height,
                     " px; give one nearer to 0"),
                 path.string()};
  }
  return light_field;
}

}  // namespace e2lf::cli
