// SPDX-License-Identifier: MIT
// Binds the module calibrate to Python.
#include <pybind11/stl.h>

#include "e2lf/calibrate/calibrate.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

py::object calibrate(const std::vector<std::vector<py::array>>& scenes, const py::array& codes,
                     const capture::SensorProfile& start, const std::vector<std::string>& held, bool even,
                     const ProgressArgument& progress) {
  std::vector<calibrate::StillScene> still;
  for (const auto& cycles : scenes) {
    calibrate::StillScene& scene = still.emplace_back();
    for (const py::array& images : cycles) scene.cycles.push_back(owned(*event_images_of(images, "scenes")));
  }
  const capture::Codes patterns = codes_of(codes, "codes");
  const calibrate::CalibrationOptions options{.held = held, .is_even = even, .progress = progress_of(progress)};
  const auto found = without_gil([&] { return calibrate::calibrate(still, patterns, start, options); });
  return make_tuple_of("Calibration", found.camera, to_python(calibrate::report_json(found)));
}

}  // namespace

void bind_calibrate(py::module_& module) {
  module.def("calibrate", &calibrate, py::arg("scenes"), py::arg("codes"), py::arg("start"), py::kw_only(),
             py::arg("held") = std::vector<std::string>(), py::arg("even") = false, py::arg("progress") = py::none(),
             "Estimates the constants of a camera with physical pixels from static scenes, as `e2lf calibrate` does. "
             "Returns Calibration(camera, report).\n\n"
             "scenes: for each scene its cycles, int16 [transition, y, x] or together [cycle, transition, y, x].\n"
             "codes: the patterns [N, view_y, view_x].\n"
             "start: the Camera with which the estimation starts.\n"
             "held: names of constants that keep their values.\n"
             "even: whether the scenes are known to be even within each cell of the field.\n"
             "progress: called with (done, total); an exception cancels the operation.");
}

}  // namespace e2lf::python
