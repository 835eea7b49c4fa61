// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "e2lf/base/strided_view.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

/// Conversion between numpy arrays and the types of the library. Returned arrays own the memory of the library, and
/// arguments are used where they lie, with their strides, if their numbers have the type of the library.
namespace e2lf::python {

namespace py = pybind11;

/// A view of the numbers of an array, which it keeps alive.
template <typename View>
struct Lent {
  py::array array;
  View view;
  const View& operator*() const { return view; }
  const View* operator->() const { return &view; }
};
using LentLightField = Lent<LightFieldView>;
using LentImages = Lent<PlanesView<const int16_t>>;

/// Returns float32 [view_y, view_x, y, x], with a last axis [channel] for colour.
[[nodiscard]] py::array to_array(lightfield::LightField light_field);
/// Returns int16 [transition, y, x].
[[nodiscard]] py::array to_array(capture::EventImages images);
/// Returns float32 [y, x], or [y, x, channel] for colour.
[[nodiscard]] py::array to_array(lightfield::Image image);
/// Returns float32 [N, view_y, view_x].
[[nodiscard]] py::array to_array(const capture::Codes& codes);
/// The same, or None.
[[nodiscard]] py::object to_array(const std::optional<capture::Codes>& codes);

/// Convert arrays to the types of the library. They fail with kShape (a wrong number of axes) and kInvalidValue (a
/// wrong type, counts beyond int16, or light fields with NaN or infinity); `name` is the location in errors.
[[nodiscard]] LentLightField light_field_of(const py::array& array, const char* name);
[[nodiscard]] LentImages event_images_of(const py::array& array, const char* name);
[[nodiscard]] lightfield::Image image_of(const py::array& array, const char* name);
[[nodiscard]] capture::Codes codes_of(const py::array& array, const char* name);

/// Returns the memory of an array that can be written, float32 of this shape, for a result. Fails with kShape and
/// kInvalidValue.
[[nodiscard]] LightFieldOutput output_of(const py::array& array, const lightfield::Shape& shape, const char* name);

/// Returns the array itself if it is float32 and row-major, or else a copy that is. Fails with kInvalidValue if the
/// values are not floating-point numbers.
[[nodiscard]] py::array_t<float, py::array::c_style> floats_of(const py::array& array, const char* name);

}  // namespace e2lf::python
