// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>

#include "e2lf/files/options.h"

namespace e2lf::python {

namespace py = pybind11;

/// Each adds what the module of its name offers; module.cpp calls them bottom to top.
void bind_base(py::module_& module);
void bind_capture(py::module_& module);
void bind_recordings(py::module_& module);
void bind_writers(py::module_& module);
void bind_cycles(py::module_& module);
void bind_lightfield(py::module_& module);
void bind_sensor(py::module_& module);
void bind_model(py::module_& module);
void bind_recon(py::module_& module);
void bind_eval(py::module_& module);
void bind_depth(py::module_& module);

/// As dict, list, str, numbers, bool and None.
[[nodiscard]] py::object to_python(const Json& json);

/// A named tuple of e2lf._types, by its name and its values.
template <typename... Values>
[[nodiscard]] py::object make_tuple_of(const char* name, Values&&... values) {
  return py::module_::import("e2lf._types").attr(name)(std::forward<Values>(values)...);
}

}  // namespace e2lf::python
