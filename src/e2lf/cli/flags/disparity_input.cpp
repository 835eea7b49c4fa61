// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/disparity_input.h"

#include "e2lf/base/text.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::Image;
namespace {

Result<Image> read_array(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(path));
  if (array.shape.size() != 2 || array.num_elements() == 0) {
    return Error{ErrorCode::kShape, cat("has shape ", shape_text(array.shape), "; a disparity map is [y, x]"),
                 path.string()};
  }
  Image image(array.shape[1], array.shape[0], 1);
  E2LF_ASSIGN_OR_RETURN(image.pixels, array.to_float(path.string()));
  return image;
}

Result<Image> read_map(const fs::path& path, const lightfield::Shape& shape) {
  Image image;
  if (path.extension() == ".npy") {
    E2LF_ASSIGN_OR_RETURN(image, read_array(path));
  } else if (path.extension() == ".pfm") {
    const auto decode = [&](const std::vector<uint8_t>& bytes) { return depth::decode_pfm(bytes, path.string()); };
    E2LF_ASSIGN_OR_RETURN(image, read_file(path).and_then(decode));
  } else {
    return Error{ErrorCode::kUnsupported, "this is not a disparity map; give .npy, .pfm or a folder of `e2lf depth`",
                 path.string()};
  }
  if (image.width == shape.width && image.height == shape.height) return image;
  return Error{ErrorCode::kShape,
               cat("has ", image.width, "x", image.height, " px, the views have ", shape.width, "x", shape.height,
                   "; give the map of this light field"),
               path.string()};
}

/// Returns the files of the maps in `path`, in the order of the cycles.
std::vector<fs::path> files_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<fs::path> files;
  for (const fs::path& cycle : lightfield::cycle_folders(path)) files.push_back(cycle / "disparity.npy");
  if (files.empty()) files.push_back(path / "disparity.npy");
  return files;
}

/// Returns the view that the record of `e2lf depth` states; maps of other programs have no record.
depth::ViewIndex view_of(const fs::path& path, const lightfield::Shape& shape) {
  std::error_code error;
  const auto record = read_json(fs::is_directory(path, error) ? path / "run.json" : record_path_beside(path));
  const depth::ViewIndex middle = depth::middle_view(shape);
  if (!record) return middle;
  const Json::json_pointer place("/notes/maps/0/view");
  if (!record->contains(place)) return middle;
  const Json& view = record->at(place);
  if (!view.is_array() || view.size() != 2 || !view[0].is_number_unsigned() || !view[1].is_number_unsigned()) {
    return middle;
  }
  const depth::ViewIndex named{view[0].get<size_t>(), view[1].get<size_t>()};
  return named.y < shape.views_y && named.x < shape.views_x ? named : middle;
}

}  // namespace

Result<DisparityMaps> read_disparity(const fs::path& path, const lightfield::Shape& shape, size_t cycles) {
  const std::vector<fs::path> files = files_of(path);
  if (files.size() != 1 && files.size() != cycles) {
    return Error{ErrorCode::kShape,
                 cat("there are ", files.size(), " disparity maps for ", cycles,
                     " cycles; give one, or those of this light field"),
                 path.string()};
  }
  DisparityMaps found{{}, view_of(path, shape)};
  for (const fs::path& file : files) {
    E2LF_ASSIGN_OR_RETURN(Image map, read_map(file, shape));
    found.maps.push_back(std::move(map));
  }
  return found;
}

}  // namespace e2lf::cli
