// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/crop.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/result_folder.h"

namespace e2lf::lightfield {
namespace {

/// Returns true if `count` items that begin at `first` and are `step` apart lie in [0, extent). The test cannot
/// overflow.
bool fits(size_t first, size_t count, size_t step, size_t extent) {
  return count > 0 && step > 0 && first < extent && count - 1 <= (extent - 1 - first) / step;
}

}  // namespace

Result<LightField> crop(const LightField& light_field, const CropRegion& region) {
  const Shape& shape = light_field.shape();
  if (!fits(region.y, region.height, 1, shape.height) || !fits(region.x, region.width, 1, shape.width)) {
    return Error{ErrorCode::kInvalidValue,
                 cat("cannot crop ", region.height, "x", region.width, " pixels at (y ", region.y, ", x ", region.x,
                     ") from views of ", shape.height, "x", shape.width, "; choose a region inside the views"),
                 ""};
  }
  LightField cropped({shape.views_y, shape.views_x, region.height, region.width, shape.channels});
  const size_t row_size = region.width * shape.channels;
  float* target = cropped.data().data();
  for (size_t view = 0; view < shape.num_views(); ++view) {
    const auto source = light_field.view(view / shape.views_x, view % shape.views_x);
    for (size_t y = 0; y < region.height; ++y, target += row_size) {
      const size_t begin = ((region.y + y) * shape.width + region.x) * shape.channels;
      std::copy_n(source.data() + begin, row_size, target);
    }
  }
  return cropped;
}

Result<LightField> select_views(const LightField& light_field, const ViewGrid& grid) {
  const Shape& shape = light_field.shape();
  if (!fits(grid.first_view_y, grid.views_y, grid.step, shape.views_y) ||
      !fits(grid.first_view_x, grid.views_x, grid.step, shape.views_x)) {
    return Error{ErrorCode::kInvalidValue,
                 cat("cannot take ", grid.views_y, "x", grid.views_x, " views with step ", grid.step, " from (",
                     grid.first_view_y, ", ", grid.first_view_x, ") of ", shape.views_y, "x", shape.views_x,
                     "; choose a grid inside the aperture"),
                 ""};
  }
  LightField selected({grid.views_y, grid.views_x, shape.height, shape.width, shape.channels});
  for (size_t view_y = 0; view_y < grid.views_y; ++view_y) {
    for (size_t view_x = 0; view_x < grid.views_x; ++view_x) {
      const auto source =
          light_field.view(grid.first_view_y + grid.step * view_y, grid.first_view_x + grid.step * view_x);
      std::copy(source.begin(), source.end(), selected.view(view_y, view_x).begin());
    }
  }
  return selected;
}

Image view_image(const LightField& light_field, size_t view_y, size_t view_x) {
  const Shape& shape = light_field.shape();
  E2LF_REQUIRE(view_y < shape.views_y && view_x < shape.views_x, "the light field has no such view");
  Image image(shape.width, shape.height, shape.channels);
  const auto view = light_field.view(view_y, view_x);
  std::copy(view.begin(), view.end(), image.pixels.begin());
  return image;
}

namespace fs = std::filesystem;
using capture::Orientation;

void orient(LightField& light_field, const Orientation& orientation) {
  const Shape& shape = light_field.shape();
  for (size_t row = 0; row < shape.views_y; ++row) {
    for (size_t column = 0; column < shape.views_x; ++column) {
      const size_t to_row = orientation.flip_y ? shape.views_y - 1 - row : row;
      const size_t to_column = orientation.flip_x ? shape.views_x - 1 - column : column;
      if (row * shape.views_x + column >= to_row * shape.views_x + to_column) continue;
      const auto view = light_field.view(row, column), other = light_field.view(to_row, to_column);
      std::swap_ranges(view.begin(), view.end(), other.begin());
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
