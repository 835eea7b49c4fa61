// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/crop.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/result_folder.h"

namespace e2lf::lightfield {
namespace {

/// Returns whether a range is not empty and lies inside the extent.
bool fits(size_t first, size_t count, size_t extent) {
  return count > 0 && first < extent && count <= extent - first;
}

}  // namespace

Result<LightField> crop(const LightFieldView& light_field, const CropRegion& region) {
  const Shape shape = shape_of(light_field);
  if (!fits(region.y, region.height, shape.height) || !fits(region.x, region.width, shape.width)) {
    return Error{ErrorCode::kInvalidValue,
                 cat("cannot crop ", region.height, "x", region.width, " pixels at (y ", region.y, ", x ", region.x,
                     ") from views of ", shape.height, "x", shape.width, "; choose a region inside the views"),
                 ""};
  }
  LightField cropped({shape.views_y, shape.views_x, region.height, region.width, shape.channels});
  const LightFieldOutput to = cropped;
  copy_values(LightFieldView(&light_field[0][0][region.y][region.x][0], to.extents, light_field.strides), to);
  return cropped;
}

Image view_image(const LightFieldView& light_field, size_t view_y, size_t view_x) {
  const Shape shape = shape_of(light_field);
  E2LF_REQUIRE(view_y < shape.views_y && view_x < shape.views_x, "the light field has no such view");
  Image image(shape.width, shape.height, shape.channels);
  copy_values(light_field[view_y][view_x],
              StridedView<float, 3>(image.pixels.data(), {shape.height, shape.width, shape.channels}));
  return image;
}

namespace fs = std::filesystem;
using capture::Orientation;

void orient(const LightFieldOutput& light_field, const Orientation& orientation) {
  const Shape shape = shape_of(light_field);
  std::vector<float> scratch(shape.view_size());
  for (size_t row = 0; row < shape.views_y; ++row) {
    for (size_t column = 0; column < shape.views_x; ++column) {
      const size_t to_row = orientation.flip_y ? shape.views_y - 1 - row : row;
      const size_t to_column = orientation.flip_x ? shape.views_x - 1 - column : column;
      if (row * shape.views_x + column >= to_row * shape.views_x + to_column) continue;
      const auto view = light_field[row][column], other = light_field[to_row][to_column];
      const StridedView<float, 3> held(scratch.data(), view.extents);
      copy_values(view, held);
      copy_values(other, view);
      copy_values(held, other);
    }
  }
}

Json views_note(const Orientation& capture, const Orientation& stored) {
  return {{"capture", capture::orientation_name(capture)}, {"stored", capture::orientation_name(stored)}};
}

Result<Orientation> stored_orientation(const fs::path& path) {
  std::error_code error;
  const bool is_folder = fs::is_directory(path, error);
  if (!is_folder && path.filename() != "lightfield.npy") return Orientation{};
  const fs::path record_path = (is_folder ? path : path.parent_path()) / "run.json";
  if (!is_our_record(record_path)) return Orientation{};
  E2LF_ASSIGN_OR_RETURN(const Json record, read_json(record_path));
  const Json::json_pointer place("/notes/views/stored");
  if (!record.contains(place)) return Orientation{};
  const std::string location = cat(record_path.string(), ": $.notes.views.stored");
  if (!record.at(place).is_string()) {
    return Error{ErrorCode::kInvalidValue,
                 "the orientation of the views is not a text; reconstruct the light field again", location};
  }
  return capture::orientation_from_name(record.at(place).get<std::string>(), location);
}

}  // namespace e2lf::lightfield
