// SPDX-License-Identifier: MIT
#include "python/binding/arrays.h"

#include <limits>
#include <string>

#include "e2lf/base/text.h"
#include "python/binding/errors.h"

namespace e2lf::python {
namespace {

using Extents = std::vector<py::ssize_t>;

template <typename... Sizes>
Extents extents(Sizes... sizes) {
  return {static_cast<py::ssize_t>(sizes)...};
}

/// Returns an array over memory of `owner`, which it keeps alive; `name` identifies the type of the owner.
template <typename Owner, typename Value>
py::array own(std::unique_ptr<Owner> owner, const char* name, const Extents& shape, Value* values) {
  const py::capsule capsule(owner.get(), name, [](PyObject* self) {
    delete static_cast<Owner*>(PyCapsule_GetPointer(self, PyCapsule_GetName(self)));
  });
  static_cast<void>(owner.release());  // now owned by the capsule
  return py::array(py::dtype::of<Value>(), shape, {}, values, capsule);
}

constexpr const char* kLightFieldName = "e2lf.light_field";
constexpr const char* kEventImagesName = "e2lf.event_images";
constexpr const char* kImageName = "e2lf.image";

/// Returns the owner with this name whose memory an array refers to, also through views of views; null if there is
/// none.
template <typename Owner>
const Owner* find_owner(const py::array& array, const char* name) {
  py::handle base = array;
  while (base && py::isinstance<py::array>(base)) base = py::reinterpret_borrow<py::array>(base).base();
  if (!base || PyCapsule_IsValid(base.ptr(), name) == 0) return nullptr;
  return static_cast<const Owner*>(PyCapsule_GetPointer(base.ptr(), name));
}

bool is_row_major(const py::array& array) {
  return (array.flags() & py::array::c_style) != 0;
}

std::vector<size_t> shape_of(const py::array& array) {
  return {array.shape(), array.shape() + array.ndim()};
}

Error shape_error(const py::array& array, const char* name, const char* wanted) {
  return {ErrorCode::kShape, cat("this is an array ", shape_text(shape_of(array)), "; give one ", wanted), name};
}

Error kind_error(const py::array& array, const char* name, const char* wanted) {
  const std::string type = py::str(array.dtype());
  return {ErrorCode::kInvalidValue, cat("the numbers are ", type, "; ", wanted), name};
}

/// Returns integers as int16.
std::vector<int16_t> counts_of(const py::array& array, const char* name) {
  if (array.dtype().kind() != 'i' && array.dtype().kind() != 'u') {
    throw ResultError(kind_error(array, name, "event images consist of signed integers, int16"));
  }
  const py::array_t<int64_t, py::array::c_style | py::array::forcecast> wide(array);
  using Limits = std::numeric_limits<int16_t>;
  const auto size = static_cast<size_t>(wide.size());
  std::vector<int16_t> counts(size);
  for (size_t i = 0; i < size; ++i) {
    const int64_t value = wide.data()[i];
    if (value < Limits::min() || value > Limits::max()) {
      throw ResultError({ErrorCode::kInvalidValue, cat("the count ", value, " does not fit into int16"), name});
    }
    counts[i] = static_cast<int16_t>(value);
  }
  return counts;
}

std::vector<float> values_of(const py::array& array, const char* name) {
  const auto floats = floats_of(array, name);
  return {floats.data(), floats.data() + floats.size()};
}

}  // namespace

py::array to_array(lightfield::LightField light_field) {
  const lightfield::Shape shape = light_field.shape();
  Extents sizes = extents(shape.views_y, shape.views_x, shape.height, shape.width);
  if (shape.channels != 1) sizes.push_back(static_cast<py::ssize_t>(shape.channels));
  auto owner = std::make_unique<lightfield::LightField>(std::move(light_field));
  float* values = owner->data().data();
  return own(std::move(owner), kLightFieldName, sizes, values);
}

py::array to_array(capture::EventImages images) {
  const Extents sizes = extents(images.count, images.height, images.width);
  auto owner = std::make_unique<capture::EventImages>(std::move(images));
  int16_t* values = owner->values.data();
  return own(std::move(owner), kEventImagesName, sizes, values);
}

py::array to_array(lightfield::Image image) {
  Extents sizes = extents(image.height, image.width);
  if (image.channels != 1) sizes.push_back(static_cast<py::ssize_t>(image.channels));
  auto owner = std::make_unique<lightfield::Image>(std::move(image));
  float* values = owner->pixels.data();
  return own(std::move(owner), kImageName, sizes, values);
}

py::array to_array(const capture::Codes& codes) {
  return py::array_t<float>(extents(codes.num_patterns, codes.views_y, codes.views_x), codes.values.data());
}

py::array_t<float, py::array::c_style> floats_of(const py::array& array, const char* name) {
  if (array.dtype().kind() != 'f') {
    throw ResultError(kind_error(array, name, "give floating-point numbers, 0 for black and 1 for white"));
  }
  return py::array_t<float, py::array::c_style | py::array::forcecast>(array);
}

Borrowed<lightfield::LightField> light_field_of(const py::array& array, const char* name) {
  const std::vector<size_t> sizes = shape_of(array);
  const bool has_colour = sizes.size() == 5;
  if ((sizes.size() != 4 && !has_colour) || (has_colour && sizes[4] != 1 && sizes[4] != 3) || array.size() == 0) {
    throw ResultError(shape_error(array, name, "[view_y, view_x, y, x], or with [channel] of 3 at the end"));
  }
  const lightfield::Shape shape{sizes[0], sizes[1], sizes[2], sizes[3], has_colour ? sizes[4] : 1};
  const auto* owner = find_owner<lightfield::LightField>(array, kLightFieldName);
  if (owner != nullptr && owner->shape() == shape && array.data() == owner->data().data() && is_row_major(array)) {
    return {array, owner};
  }
  const auto floats = floats_of(array, name);
  return Borrowed<lightfield::LightField>(lightfield::LightField(shape, {floats.data(), shape.size()}));
}

Borrowed<capture::EventImages> event_images_of(const py::array& array, const char* name) {
  const std::vector<size_t> sizes = shape_of(array);
  if (sizes.size() != 3 || array.size() == 0) {
    throw ResultError(shape_error(array, name, "[transition, y, x] of one cycle"));
  }
  const auto* owner = find_owner<capture::EventImages>(array, kEventImagesName);
  if (owner != nullptr && array.data() == owner->values.data() && is_row_major(array) &&
      sizes == std::vector{owner->count, owner->height, owner->width}) {
    return {array, owner};
  }
  capture::EventImages images;
  images.count = sizes[0];
  images.height = sizes[1];
  images.width = sizes[2];
  images.values = counts_of(array, name);
  return Borrowed<capture::EventImages>(std::move(images));
}

lightfield::Image image_of(const py::array& array, const char* name) {
  const std::vector<size_t> sizes = shape_of(array);
  const bool has_colour = sizes.size() == 3;
  if ((sizes.size() != 2 && !has_colour) || (has_colour && sizes[2] != 1 && sizes[2] != 3) || array.size() == 0) {
    throw ResultError(shape_error(array, name, "[y, x] or [y, x, 3]"));
  }
  lightfield::Image image;
  image.height = sizes[0];
  image.width = sizes[1];
  image.channels = has_colour ? sizes[2] : 1;
  image.pixels = values_of(array, name);
  return image;
}

capture::Codes codes_of(const py::array& array, const char* name) {
  const std::vector<size_t> sizes = shape_of(array);
  if (sizes.size() != 3) throw ResultError(shape_error(array, name, "[pattern, view_y, view_x]"));
  if (std::string("fiub").find(array.dtype().kind()) == std::string::npos) {
    throw ResultError(kind_error(array, name, "transmittances are numbers from 0 to 1"));
  }
  const py::array_t<float, py::array::c_style | py::array::forcecast> floats(array);
  capture::Codes codes;
  codes.num_patterns = sizes[0];
  codes.views_y = sizes[1];
  codes.views_x = sizes[2];
  codes.values.assign(floats.data(), floats.data() + floats.size());
  take(capture::validate(codes, name));
  return codes;
}

}  // namespace e2lf::python
