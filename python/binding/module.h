// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "e2lf/files/options.h"
#include "e2lf/model/model.h"

namespace e2lf::python {

namespace py = pybind11;

/// Each adds the bindings of the library module with its name; module.cpp calls them from the lowest layer to the
/// highest.
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
void bind_calibrate(py::module_& module);
void bind_video(py::module_& module);

/// Makes the devices "cuda", "cuda:N" and "torch-cpu" known to the engine, on which modules of e2lf.torch compute
/// networks.
void add_torch_devices();

/// Lets the TypeErrors of all functions and methods of the module show the types of the arguments in place of their
/// values.
void shorten_type_errors(const py::module_& module);

/// Reads a model file, or the bundled model of this name.
[[nodiscard]] std::shared_ptr<model::Model> read_model(const std::filesystem::path& name,
                                                       const std::optional<py::array>& codes = {});

/// Converts JSON to dict, list, str, numbers, bool and None.
[[nodiscard]] py::object to_python(const Json& json);

/// Converts dict, list, str, numbers, bool and None to JSON.
[[nodiscard]] Json from_python(const py::object& value);

/// Creates a named tuple of e2lf._types from its name and its values.
template <typename... Values>
[[nodiscard]] py::object make_tuple_of(const char* name, Values&&... values) {
  return py::module_::import("e2lf._types").attr(name)(std::forward<Values>(values)...);
}

}  // namespace e2lf::python
