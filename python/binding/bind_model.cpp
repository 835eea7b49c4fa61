// SPDX-License-Identifier: MIT
// Binds the module model to Python.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "e2lf/files/bundled_files.h"
#include "e2lf/model/model.h"
#include "e2lf/model/summary.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {

namespace {

std::shared_ptr<model::Model> read_model(const std::filesystem::path& name) {
  return std::make_shared<model::Model>(without_gil([&]() -> Result<model::Model> {
    E2LF_ASSIGN_OR_RETURN(const auto path, find_file_or_bundled(kBundledModels, name.string()));
    return model::read_model(path);
  }));
}

}  // namespace

void bind_model(py::module_& module) {
  using model::Model;
  py::class_<Model, std::shared_ptr<Model>>(module, "Model", "The content of a model file.")
      .def(py::init(&read_model), py::arg("name"), "Reads a model as read_model() does.")
      .def_readonly("name", &Model::name, "The name in the model file.")
      .def_readonly("num_patterns", &Model::num_patterns,
                    "The number N of patterns; reconstruction takes N - 1 event images.")
      .def_property_readonly(
          "views", [](const Model& self) { return py::make_tuple(self.views_y, self.views_x); },
          "The number of views, (view_y, view_x).")
      .def_property_readonly(
          "codes",
          [](const Model& self) { return self.codes ? py::object(to_array(*self.codes)) : py::object(py::none()); },
          "The patterns, float32 [N, view_y, view_x]; None if the model does not contain them.")
      .def_readonly("event_model", &Model::event_model, "The event model for which it was trained.")
      .def_readonly("black_first", &Model::black_first, "Whether the first pattern is black.")
      .def_readonly("constants", &Model::constants, "The sensor constants for which it was trained.")
      .def_readonly("camera", &Model::camera, "The camera that is used unless another is given, or None.")
      .def_property_readonly(
          "is_conditioned_on_camera", [](const Model& self) { return model::is_conditioned_on_camera(self); },
          "Whether the network is conditioned on the sensor profile and accepts sums over cycles.")
      .def(
          "summary", [](const Model& self) { return to_python(model::summary_json(self)); },
          "Returns the content of `e2lf model info --json`.")
      .def("__str__", [](const Model& self) { return model::summary_text(self); })
      .def("__repr__", [](const Model& self) { return "<e2lf.Model " + self.name + ">"; });
  module.def("read_model", &read_model, py::arg("path"),
             "Reads a model.\n\npath: a model file, or the name of a bundled model, such as \"e2lf-n4\".");
}

}  // namespace e2lf::python
