// SPDX-License-Identifier: MIT
// Reads light fields that are one array in a file of numpy or MATLAB, and writes those of numpy; declared in readers.h.
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/elements.h"
#include "e2lf/files/file.h"
#include "e2lf/files/mat5.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

/// Returns whether samples of this numpy type may be those of a light field; i1 and i2 are event counts.
bool is_sample_type(const std::string& code) {
  return element_size(code) > 0 && code != "i1" && code != "i2";
}

}  // namespace

const NpyArray* find_light_field(const NpzArrays& arrays) {
  for (const char* name : {"light_field", "lightfield", "LF"}) {
    if (const auto found = arrays.find(name); found != arrays.end()) return &found->second;
  }
  if (arrays.size() == 1) return &arrays.begin()->second;
  // Beside it, there may be disparities or parameters, which have fewer axes.
  const NpyArray* only = nullptr;
  for (const auto& [name, array] : arrays) {
    if (array.shape.size() < 4) continue;
    if (only != nullptr) return nullptr;
    only = &array;
  }
  return only;
}

std::optional<Shape> npy_shape(const NpyArray& array) {
  const std::vector<size_t>& extents = array.shape;
  if (!is_sample_type(array.type)) return std::nullopt;
  if (extents.size() == 5 && (extents[4] == 1 || extents[4] == 3)) {
    return Shape{extents[0], extents[1], extents[2], extents[3], extents[4]};
  }
  // Four axes that end in 1 or 3 are ambiguous. Two small equal extents in front are taken as a grid of views rather
  // than as a number of views.
  const bool grid = extents.size() == 4 && extents[0] == extents[1] && extents[0] <= 32;
  const bool flat_colour = extents.size() == 4 && !grid && (extents[3] == 1 || extents[3] == 3);
  if (extents.size() == 4 && !flat_colour) return Shape{extents[0], extents[1], extents[2], extents[3], 1};
  if (extents.size() != 3 && !flat_colour) return std::nullopt;
  const size_t views = views_per_axis(extents[0]);
  if (views == 0) return std::nullopt;
  return Shape{views, views, extents[1], extents[2], flat_colour ? extents[3] : 1};
}

Result<LightField> from_npy(const NpyArray& array, const ReadOptions& options, const std::string& location) {
  const std::optional<Shape> shape = npy_shape(array);
  if (!shape) {
    return fail(ErrorCode::kShape, location, "an array ", shape_text(array.shape), " of type ",
                array.type.empty() ? "record" : array.type,
                " is not a light field; store float32 or uint8 [view_y, view_x, y, x] or [view, y, x], colour last");
  }
  const bool may_have_channels = shape->views_x == 3 || shape->views_x == 1;
  if (may_have_channels && shape->views_y > 3 && views_per_axis(shape->views_y) > 0) {
    log_warning(cat(location, ": read as ", shape->views_y, "x", shape->views_x,
                    " views; if the axes are [view, channel, y, x], put the channel last"));
  }
  return from_stored({.shape = *shape,
                      .strides = uvhwc_strides(*shape),
                      .type = array.type,
                      .bytes = array.bytes,
                      .white = white_of_type(array.type)},
                     options, location);
}

Result<LightField> read_mat(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string() + ": LF";
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> file, read_file(path));
  const Result<MatArray> found = find_mat_array(file, "LF", options.max_bytes, location);
  if (!found && found.error().code == ErrorCode::kNotFound) {
    E2LF_ASSIGN_OR_RETURN(const std::vector<std::string> names, mat_variables(path));
    return fail(ErrorCode::kNotFound, path, "the file contains no light field LF, but ",
                names.empty() ? "no variable" : join(names),
                "; save a light field under that name, and events as .csv with the columns t, x, y, p");
  }
  if (!found) return found.error();
  const MatArray& variable = *found;
  if (variable.class_type.empty() || variable.complex) {
    return fail(ErrorCode::kUnsupported, location,
                "not of class double, single, logical or integers of 8 to 32 bits, or complex; convert it");
  }
  const std::vector<size_t>& extents = variable.extents;
  if (extents.size() != 4 && extents.size() != 5) {
    return fail(ErrorCode::kShape, location, "has extents ", shape_text(extents), "; store (U,V,H,W) or (U,V,H,W,C)");
  }
  StoredArray array;
  array.shape = {extents[0], extents[1], extents[2], extents[3], extents.size() == 5 ? extents[4] : 1};
  array.strides = matlab_uvhwc_strides(array.shape);
  array.white = variable.logical ? 1.0F : white_of_type(variable.class_type);
  // MATLAB stores numbers as a smaller type than that of their class if all of them fit.
  array.type = variable.type;
  E2LF_RETURN_IF_ERROR(check_memory(array.shape, element_size(array.type), options, location));
  array.bytes = variable.data;
  if (array.type.empty() || array.bytes.size() != array.num_bytes()) {
    return fail(ErrorCode::kFormat, location, "the samples do not fill ", shape_text(extents), "; save the file again");
  }
  return from_stored(array, options, location);
}

Result<void> write_npy_light_field(const std::filesystem::path& path, const LightFieldView& light_field) {
  const Shape shape = shape_of(light_field);
  std::vector<size_t> extents = {shape.views_y, shape.views_x, shape.height, shape.width};
  if (shape.channels == 3) extents.push_back(3);
  std::vector<float> scratch;
  return write_npy(path, make_npy<float>(std::move(extents), light_field.values(scratch)));
}

}  // namespace e2lf::lightfield
