// SPDX-License-Identifier: MIT
#include "e2lf/depth/true_disparity.h"

#include "e2lf/base/text.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"

namespace e2lf::depth {
namespace fs = std::filesystem;
using lightfield::Image;

Result<Image> read_disparity(const fs::path& path) {
  if (path.extension() == ".pfm") {
    return read_file(path).and_then([&](const auto& bytes) { return decode_pfm(bytes, path.string()); });
  }
  if (path.extension() != ".npy") {
    return fail(ErrorCode::kUnsupported, path, "this is not a disparity map; give .npy or .pfm");
  }
  E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(path));
  if (array.shape.size() != 2 || array.num_elements() == 0) {
    return fail(ErrorCode::kShape, path, "has shape ", shape_text(array.shape), "; a disparity map is [y, x]");
  }
  Image image(array.shape[1], array.shape[0], 1);
  E2LF_ASSIGN_OR_RETURN(image.pixels, array.to_float(path.string()));
  return image;
}

std::optional<fs::path> find_true_disparity(const fs::path& scene) {
  for (const char* name : {"gt_disparity.npy", "gt_disp_lowres.pfm"}) {
    std::error_code error;
    if (fs::is_regular_file(scene / name, error)) return scene / name;
  }
  return std::nullopt;
}

Result<TrueDisparity> true_disparity(const lightfield::LightField& true_views, const std::optional<fs::path>& file) {
  if (!file) {
    E2LF_ASSIGN_OR_RETURN(DisparityMap map, estimate_disparity(true_views));
    return TrueDisparity{std::move(map.disparity), kDepthOfTrueViews};
  }
  E2LF_ASSIGN_OR_RETURN(Image disparity, read_disparity(*file));
  const lightfield::Shape& shape = true_views.shape();
  if (disparity.width == shape.width && disparity.height == shape.height) {
    return TrueDisparity{std::move(disparity), file->string()};
  }
  return fail(ErrorCode::kShape, file->string(), "has ", disparity.width, "x", disparity.height, " px, the views have ",
              shape.width, "x", shape.height, "; give the map of this light field");
}

Result<FoundDisparity> judge_disparity(const lightfield::LightField& light_field, const Image& truth,
                                       const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(DisparityMap map, estimate_disparity(light_field, {}, progress));
  E2LF_ASSIGN_OR_RETURN(DisparityError error, compare(map.disparity, map.confidence, truth));
  return FoundDisparity{std::move(map.disparity), std::move(error)};
}

bool has_comparable_disparity(const lightfield::Shape& shape) {
  return shape.num_views() > 1 && shape.height > 2 * kErrorBorderPx && shape.width > 2 * kErrorBorderPx;
}

}  // namespace e2lf::depth
