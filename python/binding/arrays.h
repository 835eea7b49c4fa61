// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <utility>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

/// Conversion between numpy arrays and the types of the library. Returned arrays own the memory of the library, so that
/// nothing is copied. If such an array is passed back unchanged, its memory is used; any other array is copied once.
namespace e2lf::python {

namespace py = pybind11;

/// An object of the library that an array owns, or a copy of the values of an array. Keeps the array alive.
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

/// Returns float32 [view_y, view_x, y, x], with a last axis [channel] for colour.
[[nodiscard]] py::array to_array(lightfield::LightField light_field);
/// Returns int16 [transition, y, x].
[[nodiscard]] py::array to_array(capture::EventImages images);
/// Returns float32 [y, x], or [y, x, channel] for colour.
[[nodiscard]] py::array to_array(lightfield::Image image);
/// Returns float32 [N, view_y, view_x].
[[nodiscard]] py::array to_array(const capture::Codes& codes);

/// Convert arrays to the types of the library. They fail with kShape (a wrong number of axes) and kInvalidValue (a
/// wrong type, or counts beyond int16); `name` is the location in errors.
[[nodiscard]] Borrowed<lightfield::LightField> light_field_of(const py::array& array, const char* name);
[[nodiscard]] Borrowed<capture::EventImages> event_images_of(const py::array& array, const char* name);
[[nodiscard]] lightfield::Image image_of(const py::array& array, const char* name);
[[nodiscard]] capture::Codes codes_of(const py::array& array, const char* name);

/// Returns the array itself if it is float32 and row-major, or else a copy that is. Fails with kInvalidValue if the
/// values are not floating-point numbers.
[[nodiscard]] py::array_t<float, py::array::c_style> floats_of(const py::array& array, const char* name);

}  // namespace e2lf::python
