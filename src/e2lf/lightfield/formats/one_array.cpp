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

/// Returns the type to read an array as. Types other than these four are converted to float32 first.
std::optional<SampleType> sample_type(const std::string& code) {
  if (code == "u1") return SampleType::kUint8;
  if (code == "u2") return SampleType::kUint16;
  if (code == "f8") return SampleType::kFloat64;
  for (const char* other : {"f4", "f2", "b1", "u4", "u8", "i4", "i8"}) {
    if (code == other) return SampleType::kFloat32;
  }
  return std::nullopt;  // i1 and i2 are event counts
}

/// Returns true if the type determines which number is white.
bool has_white(const std::string& code) {
  return code == "u1" || code == "u2" || code == "b1" || code[0] == 'f';
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
  if (!sample_type(array.type)) return std::nullopt;
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
  if (!has_white(array.type) && options.white == 0.0F) {
    return Error{ErrorCode::kUnsupported,
                 cat("whole numbers of type ", array.type, " do not determine which value is white; give it, e.g. 255"),
                 location, Setting::kWhite};
  }
  StoredArray stored;
  stored.shape = *shape;
  stored.strides = uvhwc_strides(*shape);
  stored.type = *sample_type(array.type);
  stored.bytes = array.bytes;
  std::vector<float> widened;
  if (stored.type == SampleType::kFloat32 && array.type != "f4") {
    E2LF_ASSIGN_OR_RETURN(widened, array.to_float(location));
    stored.bytes = {reinterpret_cast<const uint8_t*>(widened.data()), widened.size() * sizeof(float)};
  }
  return from_stored(stored, options, location);
}

namespace {

/// Returns the number that is white in an array of this class, or 0 if the class does not determine it.
float white_of_class(const MatArray& variable) {
  if (variable.logical) return 1.0F;
  switch (static_cast<MatClass>(variable.array_class)) {
    case MatClass::kUint8:
      return 255.0F;
    case MatClass::kUint16:
      return 65535.0F;
    case MatClass::kSingle:
    case MatClass::kDouble:
      return 1.0F;
    default:
      return 0.0F;
  }
}

/// Returns the stored type of the samples if from_stored() can read it.
std::optional<SampleType> type_of_code(std::string_view code) {
  if (code == "u1") return SampleType::kUint8;
  if (code == "u2") return SampleType::kUint16;
  if (code == "f4") return SampleType::kFloat32;
  return code == "f8" ? std::optional(SampleType::kFloat64) : std::nullopt;
}

}  // namespace

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
  const bool is_number = variable.array_class >= static_cast<uint8_t>(MatClass::kDouble) &&
                         variable.array_class <= static_cast<uint8_t>(MatClass::kUint32);
  if (!is_number || variable.complex) {
    return fail(ErrorCode::kUnsupported, location,
                "not of class double, single, logical or integers of 8 to 32 bits, or complex; convert it");
  }
  const float white = white_of_class(variable);
  if (white == 0.0F && options.white == 0.0F) {
    return Error{ErrorCode::kUnsupported,
                 "integers of this class do not determine which value is white; give it, e.g. 255", location,
                 Setting::kWhite};
  }
  const std::vector<size_t>& extents = variable.extents;
  if (extents.size() != 4 && extents.size() != 5) {
    return fail(ErrorCode::kShape, location, "has extents ", shape_text(extents), "; store (U,V,H,W) or (U,V,H,W,C)");
  }
  StoredArray array;
  array.shape = {extents[0], extents[1], extents[2], extents[3], extents.size() == 5 ? extents[4] : 1};
  array.strides = matlab_uvhwc_strides(array.shape);
  array.white = white;
  // MATLAB stores numbers as a smaller type than that of their class if all of them fit.
  const std::string code = numpy_code(variable.storage);
  const auto type = type_of_code(code);
  array.type = type.value_or(SampleType::kFloat32);
  E2LF_RETURN_IF_ERROR(check_memory(array.shape, sample_bytes(array.type), options, location));

  std::vector<float> widened;
  array.bytes = variable.data;
  if (!type) {
    E2LF_ASSIGN_OR_RETURN(widened, elements_to_float(code, variable.data, location));
    array.bytes = {reinterpret_cast<const uint8_t*>(widened.data()), widened.size() * sizeof(float)};
  }
  if (array.bytes.size() != array.shape.size() * sample_bytes(array.type)) {
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
