// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/orient.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/result_folder.h"

namespace e2lf::lightfield {
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
