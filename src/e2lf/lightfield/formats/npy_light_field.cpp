// SPDX-License-Identifier: MIT
// Reads light fields in numpy files; declared in readers.h.
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
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
    return Error{
        ErrorCode::kShape,
        cat("an array ", shape_text(array.shape), " of type ", array.type.empty() ? "record" : array.type,
            " is not a light field; store float32 or uint8 [view_y, view_x, y, x] or [view, y, x], colour last"),
        location};
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

}  // namespace e2lf::lightfield
