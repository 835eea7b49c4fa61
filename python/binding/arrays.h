// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <utility>
#include <vector>

#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

/// Arrays of numpy and the library's types. Arrays that come out own the library's memory: nothing is copied. One that
/// goes in again whole is that memory; any other is copied once.
namespace e2lf::python {

namespace py = pybind11;

/// Something of the library that an array lends, or a copy of an array's values. Keeps the array alive.
template <typename T>
class Borrowed {
 public:
  Borrowed(py::object owner, const T* lent) : owner_(std::move(owner)), value_(lent) {}
  explicit Borrowed(T copy) : copy_(std::make_unique<T>(std::move(copy))), value_(copy_.get()) {}
  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_; }
  [[nodiscard]] bool is_copy() const { return copy_ != nullptr; }

 private:
  py::object owner_;
  std::unique_ptr<T> copy_;
  const T* value_;
};

/// float32 [view_y, view_x, y, x], or with [channel] at the end where there is colour.
[[nodiscard]] py::array to_array(lightfield::LightField light_field);
/// int16 [transition, y, x].
[[nodiscard]] py::array to_array(capture::EventImages images);
/// float32 [y, x], or [y, x, channel] where there is colour.
[[nodiscard]] py::array to_array(lightfield::Image image);
/// float32 [N, view_y, view_x].
[[nodiscard]] py::array to_array(const capture::Codes& codes);

/// The other way. They fail with kShape on another number of axes and with kInvalidValue on another kind of numbers, or
/// counts beyond int16; `name` is the location in errors.
[[nodiscard]] Borrowed<lightfield::LightField> light_field_of(const py::array& array, const char* name);
[[nodiscard]] Borrowed<capture::EventImages> event_images_of(const py::array& array, const char* name);
[[nodiscard]] lightfield::Image image_of(const py::array& array, const char* name);
[[nodiscard]] capture::Codes codes_of(const py::array& array, const char* name);

/// The values as they lie, where they are float32 and row-major, else a copy that is. Fails with kInvalidValue where
/// they are no floating-point numbers.
[[nodiscard]] py::array_t<float, py::array::c_style> floats_of(const py::array& array, const char* name);

}  // namespace e2lf::python
