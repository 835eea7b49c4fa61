// SPDX-License-Identifier: MIT
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
  py::class_<Model, std::shared_ptr<Model>>(module, "Model", "What a model file holds.")
      .def(py::init(&read_model), py::arg("name"), "As read_model().")
      .def_readonly("name", &Model::name, "As its file says.")
      .def_readonly("num_patterns", &Model::num_patterns, "N; reconstruction takes N - 1 event images.")
      .def_property_readonly(
          "views", [](const Model& self) { return py::make_tuple(self.views_y, self.views_x); }, "(view_y, view_x).")
      .def_property_readonly(
          "codes",
          [](const Model& self) { return self.codes ? py::object(to_array(*self.codes)) : py::object(py::none()); },
          "The patterns, float32 [N, view_y, view_x]; None where they belong to somebody's camera.")
      .def_readonly("event_model", &Model::event_model, "What it was trained for.")
      .def_readonly("black_first", &Model::black_first, "Whether the first pattern is black.")
      .def_readonly("constants", &Model::constants, "What it was trained for.")
      .def_readonly("camera", &Model::camera, "The camera that it is used with where no other is named, or None.")
      .def_property_readonly(
          "is_told_the_camera", [](const Model& self) { return model::is_told_the_camera(self); },
          "Whether the network takes the constants of the camera and a number of cycles.")
      .def(
          "summary", [](const Model& self) { return to_python(model::summary_json(self)); },
          "What `e2lf model info --json` says.")
      .def("__str__", [](const Model& self) { return model::summary_text(self); })
      .def("__repr__", [](const Model& self) { return "<e2lf.Model " + self.name + ">"; });
  module.def("read_model", &read_model, py::arg("path"),
             "Reads a model.\n\npath: of a model file, or the name of a bundled model, such as \"e2lf-n4\".");
}

}  // namespace e2lf::python
