// SPDX-License-Identifier: MIT
#include "python/binding/arrays.h"

#include <cmath>
#include <limits>
#include <string>

#include "e2lf/base/text.h"
#include "python/binding/calls.h"

namespace e2lf::python {
namespace {

using Extents = std::vector<py::ssize_t>;

template <typename... Sizes>
Extents extents(Sizes... sizes) {
  return {static_cast<py::ssize_t>(sizes)...};
}

/// Returns an array over memory of `owner`, which it keeps alive.
template <typename Owner, typename Value>
py::array own(std::unique_ptr<Owner> owner, const Extents& shape, Value* values) {
  const py::capsule capsule(owner.get(), [](void* self) { delete static_cast<Owner*>(self); });
  static_cast<void>(owner.release());  // now owned by the capsule
  return py::array(py::dtype::of<Value>(), shape, {}, values, capsule);
}

/// Returns whether the numbers of an array are of this type, in the order of bytes and at addresses of this machine.
template <typename Value>
bool holds(const py::array& array) {
  bool is_aligned = reinterpret_cast<uintptr_t>(array.data()) % alignof(Value) == 0;
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
    is_aligned = is_aligned && array.strides(axis) % static_cast<py::ssize_t>(sizeof(Value)) == 0;
  }
  return is_aligned && py::isinstance<py::array_t<Value, 0>>(array);
}

/// Returns the view of an array that holds such numbers. Axes that it lacks at the end have the extent 1.
template <typename Value, size_t kAxes>
StridedView<Value, kAxes> view_of(const py::array& array) {
  StridedView<Value, kAxes> view;
  view.data = const_cast<Value*>(static_cast<const Value*>(array.data()));
  view.extents.fill(1);
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
    view.extents[static_cast<size_t>(axis)] = static_cast<size_t>(array.shape(axis));
    view.strides[static_cast<size_t>(axis)] = array.strides(axis) / static_cast<py::ssize_t>(sizeof(Value));
  }
  return view;
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
py::array counts_of(const py::array& array, const char* name) {
  if (array.dtype().kind() != 'i' && array.dtype().kind() != 'u') {
    throw ResultError(kind_error(array, name, "event images consist of signed integers, int16"));
  }
  const py::array_t<int64_t, py::array::c_style | py::array::forcecast> wide(array);
  using Limits = std::numeric_limits<int16_t>;
  py::array_t<int16_t> counts(Extents(array.shape(), array.shape() + array.ndim()));
  for (py::ssize_t i = 0; i < wide.size(); ++i) {
    const int64_t value = wide.data()[i];
    if (value < Limits::min() || value > Limits::max()) {
      throw ResultError({ErrorCode::kInvalidValue, cat("the count ", value, " does not fit into int16"), name});
    }
    counts.mutable_data()[i] = static_cast<int16_t>(value);
  }
  return counts;
}

std::vector<float> values_of(const py::array& array, const char* name) {
  const auto floats = floats_of(array, name);
  return {floats.data(), floats.data() + floats.size()};
}

void check_finite(const LightFieldView& field, const char* name) {
  without_gil([&]() -> Result<void> {
    bool is_finite = true;
    for_each_value(field, [&](float value) { is_finite = is_finite && std::isfinite(value); });
    if (is_finite) return {};
    return Error{ErrorCode::kInvalidValue, "it contains NaN or infinity; replace them first", name};
  });
}

}  // namespace

py::array to_array(lightfield::LightField light_field) {
  const lightfield::Shape shape = light_field.shape();
  Extents sizes = extents(shape.views_y, shape.views_x, shape.height, shape.width);
  if (shape.channels != 1) sizes.push_back(static_cast<py::ssize_t>(shape.channels));
  auto owner = std::make_unique<lightfield::LightField>(std::move(light_field));
  float* values = owner->data().data();
  return own(std::move(owner), sizes, values);
}

py::array to_array(capture::EventImages images) {
  const Extents sizes = extents(images.count, images.height, images.width);
  auto owner = std::make_unique<capture::EventImages>(std::move(images));
  int16_t* values = owner->values.data();
  return own(std::move(owner), sizes, values);
}

py::array to_array(lightfield::Image image) {
  Extents sizes = extents(image.height, image.width);
  if (image.channels != 1) sizes.push_back(static_cast<py::ssize_t>(image.channels));
  auto owner = std::make_unique<lightfield::Image>(std::move(image));
  float* values = owner->pixels.data();
  return own(std::move(owner), sizes, values);
}

py::array to_array(const capture::Codes& codes) {
  return py::array_t<float>(extents(codes.num_patterns, codes.views_y, codes.views_x), codes.values.data());
}

py::object to_array(const std::optional<capture::Codes>& codes) {
  return codes ? py::object(to_array(*codes)) : py::none();
}

py::array_t<float, py::array::c_style> floats_of(const py::array& array, const char* name) {
  if (array.dtype().kind() != 'f') {
    throw ResultError(kind_error(array, name, "give floating-point numbers, 0 for black and 1 for white"));
  }
  return py::array_t<float, py::array::c_style | py::array::forcecast>(array);
}

LentLightField light_field_of(const py::array& array, const char* name) {
  const std::vector<size_t> sizes = shape_of(array);
  const bool has_colour = sizes.size() == 5;
  if ((sizes.size() != 4 && !has_colour) || (has_colour && sizes[4] != 1 && sizes[4] != 3) || array.size() == 0) {
    throw ResultError(shape_error(array, name, "[view_y, view_x, y, x], or with [channel] of 3 at the end"));
  }
  const py::array floats = holds<float>(array) ? array : py::array(floats_of(array, name));
  LentLightField field{floats, view_of<const float, 5>(floats)};
  check_finite(*field, name);
  return field;
}

LightFieldOutput output_of(const py::array& array, const lightfield::Shape& shape, const char* name) {
  if (!holds<float>(array) || !array.writeable()) {
    throw ResultError(kind_error(array, name, "give an array of float32 that can be written"));
  }
  const bool has_axes = array.ndim() == (shape.channels == 1 ? 4 : 5);
  const auto view = has_axes ? view_of<float, 5>(array) : LightFieldOutput();
  if (!(lightfield::shape_of(view) == shape)) {
    const std::vector<size_t> wanted = {shape.views_y, shape.views_x, shape.height, shape.width};
    throw ResultError(shape_error(array, name, shape_text(wanted).c_str()));
  }
  return view;
}

LentImages event_images_of(const py::array& array, const char* name) {
  if (array.ndim() != 3 || array.size() == 0) {
    throw ResultError(shape_error(array, name, "[transition, y, x] of one cycle"));
  }
  const py::array counts = holds<int16_t>(array) ? array : counts_of(array, name);
  return {counts, view_of<const int16_t, 3>(counts)};
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
