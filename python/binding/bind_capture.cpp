// SPDX-License-Identifier: MIT
// Binds the module capture to Python.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/capture/measurement/recorded_setup.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/options.h"
#include "e2lf/info/page_parts.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "python/binding/arguments.h"
#include "python/binding/arrays.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace fs = std::filesystem;
namespace {

using capture::SensorConstants;

void bind_constants(py::module_& module) {
  py::class_<SensorConstants>(
      module, "SensorConstants",
      "The constants of the paper's event sensor, those of a Prophesee EVK4 by default.\n\n"
      "eps: dark level added to the intensity.\ntau: contrast threshold, natural logarithm.\n"
      "sigma_w: standard deviation of the log-intensity noise.\nsigma_z: standard deviation of the threshold.")
      .def(py::init([](float eps, float tau, float sigma_w, float sigma_z) {
             return SensorConstants{eps, tau, sigma_w, sigma_z};
           }),
           py::arg("eps") = json_number(SensorConstants().eps).get<double>(),
           py::arg("tau") = json_number(SensorConstants().tau).get<double>(),
           py::arg("sigma_w") = json_number(SensorConstants().sigma_w).get<double>(),
           py::arg("sigma_z") = json_number(SensorConstants().sigma_z).get<double>())
      .def_readwrite("eps", &SensorConstants::eps, "Dark level added to the intensity.")
      .def_readwrite("tau", &SensorConstants::tau, "Contrast threshold, natural logarithm.")
      .def_readwrite("sigma_w", &SensorConstants::sigma_w, "Standard deviation of the log-intensity noise.")
      .def_readwrite("sigma_z", &SensorConstants::sigma_z, "Standard deviation of the threshold.")
      .def("__eq__", [](const SensorConstants& self, const SensorConstants& other) { return self == other; })
      .def("__repr__",
           [](const SensorConstants& self) {
             return cat("SensorConstants(eps=", self.eps, ", tau=", self.tau, ", sigma_w=", self.sigma_w,
                        ", sigma_z=", self.sigma_z, ")");
           })
      .def(py::pickle(
          [](const SensorConstants& self) { return py::make_tuple(self.eps, self.tau, self.sigma_w, self.sigma_z); },
          [](const py::tuple& state) {
            return SensorConstants{state[0].cast<float>(), state[1].cast<float>(), state[2].cast<float>(),
                                   state[3].cast<float>()};
          }));
}

capture::SensorProfile read_camera(const fs::path& name) {
  return take(capture::read_camera(take(find_file_or_bundled(kBundledCameras, name.string()))));
}

void bind_camera(py::module_& module) {
  using capture::SensorProfile;
  py::class_<SensorProfile>(module, "Camera",
                            "The sensor profile of a camera: the model and the constants of its pixels.")
      .def(py::init(&read_camera), py::arg("name"), "Reads a camera as read_camera() does.")
      .def_readonly("name", &SensorProfile::name, "The name in the camera file.")
      .def_readonly("event_model", &SensorProfile::event_model, "\"reference-aware\", \"quantised\" or \"pixel\".")
      .def_readonly("constants", &SensorProfile::constants,
                    "Constants of the paper's models; for \"pixel\", only eps and the mean threshold.")
      .def_property_readonly(
          "views", [](const SensorProfile& self) { return orientation_word(self.views); }, kViewsDoc)
      .def_static(
          "from_dict",
          [](const py::dict& content) { return take(capture::camera_from_json(from_python(content), "camera")); },
          py::arg("content"), "Makes a camera from the content of a camera file.\n\ncontent: as to_dict() returns it.")
      .def_static(
          "from_constants",
          [](const SensorConstants& constants) {
            SensorProfile camera;
            camera.constants = constants;
            return camera;
          },
          py::arg("constants"), "Returns a camera of the paper's models.\n\nconstants: its SensorConstants.")
      .def(
          "conditioning",
          [](const SensorProfile& self, Whole<size_t> num_patterns, Whole<size_t> cycles) {
            if (num_patterns < 2 || cycles < 1) throw py::value_error("there are 2 patterns and 1 cycle at least");
            const auto vector = capture::conditioning_vector(self, num_patterns, cycles);
            return py::array_t<float>(static_cast<py::ssize_t>(vector.size()), vector.data());
          },
          py::arg("num_patterns"), py::arg("cycles") = 1,
          "Returns the vector by which networks are conditioned on the camera, float32 [number].\n\n"
          "num_patterns: number of patterns. cycles: number of cycles over which the counts are averaged.")
      .def(
          "to_dict", [](const SensorProfile& self) { return to_python(capture::to_json(self)); },
          "Returns the content of a camera file: every constant with its uncertainty.")
      .def("__repr__",
           [](const SensorProfile& self) { return "<e2lf.Camera " + self.name + ", " + self.event_model + ">"; })
      .def("__eq__", [](const SensorProfile& self,
                        const SensorProfile& other) { return capture::to_json(self) == capture::to_json(other); })
      .def(py::pickle([](const SensorProfile& self) { return json_line(capture::to_json(self)); },
                      [](const std::string& state) {
                        return take(capture::camera_from_json(take(parse_json(state, "camera")), "camera"));
                      }));
  module.def("read_camera", &read_camera, py::arg("name"),
             "Reads a camera.\n\nname: the path of a camera file, or the name of a bundled camera: \"evk4-lcos\", "
             "\"ideal\" or \"paper\".");
}

void bind_codes(py::module_& module) {
  module.def(
      "read_codes",
      [](const fs::path& path) {
        return to_array(take(pipeline::read_patterns(take(find_file_or_bundled(kBundledCodes, path.string())))));
      },
      py::arg("path"),
      "Reads aperture patterns: float32 [N, view_y, view_x], 0 = closed, 1 = open.\n\n"
      "path: a .json, .npy or .npz file of patterns, a model file, or the name of a bundled model.");
  module.def(
      "write_codes",
      [](const fs::path& path, const py::array& codes, bool overwrite) {
        const capture::Codes values = codes_of(codes, "codes");
        write_output(path, overwrite, [&](const fs::path& place) { return capture::write_codes(place, values); });
      },
      py::arg("path"), py::arg("codes"), py::kw_only(), py::arg("overwrite") = false,
      "Writes patterns as .json, .npy or .npz.\n\ncodes: [N, view_y, view_x], 0 = closed, 1 = open.");
  module.def(
      "default_codes", [] { return to_array(capture::default_codes()); },
      "Returns four binary patterns of 8x8 cells for demonstrations, black first: float32 [4, 8, 8].");
}

/// Returns the content of a file of event images as an EventImageFile.
py::object read_event_images(const fs::path& path) {
  auto file = without_gil([&] { return capture::read_event_images(path); });
  py::list cycles;
  for (capture::EventImages& images : file.cycles) cycles.append(to_array(std::move(images)));
  return make_tuple_of("EventImageFile", std::move(cycles), to_array(file.setup.codes), file.setup.camera,
                       orientation_word(file.setup.views));
}

void write_event_images(const fs::path& path, const std::vector<py::array>& cycles,
                        const std::optional<py::array>& codes, const capture::SensorProfile* camera,
                        const std::optional<std::string>& views, bool overwrite) {
  capture::RecordedSetup setup;
  if (codes) setup.codes = codes_of(*codes, "codes");
  if (camera != nullptr) setup.camera = *camera;
  if (views) setup.views = take(capture::orientation_from_name(*views, "views"));
  std::vector<LentImages> all;
  for (const py::array& images : cycles) all.push_back(event_images_of(images, "cycles"));
  write_output(path, overwrite, [&](const fs::path& place) -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(const auto writer, capture::EventImageWriter::create(place));
    writer->keep(setup);
    for (const auto& images : all) E2LF_RETURN_IF_ERROR(writer->add(owned(*images)));
    return writer->finish();
  });
}

void bind_event_images(py::module_& module) {
  module.def(
      "read_event_images", &read_event_images, py::arg("path"),
      "Reads event images from an .npz, an .npy or a folder of event_image_00000.npy ... Returns "
      "EventImageFile(cycles, codes, camera, views): a list of int16 [transition, y, x], one for each cycle, and "
      "the patterns, the camera and the orientation of the views, each None if the file does not contain it.");
  module.def("write_event_images", &write_event_images, py::arg("path"), py::arg("cycles"),
             py::arg("codes") = py::none(), py::kw_only(), py::arg("camera") = nullptr, py::arg("views") = py::none(),
             py::arg("overwrite") = false,
             "Writes an .npz with `events` int16 [cycle, transition, y, x] and, if they are given, `codes` "
             "[N, view_y, view_x], `camera` and `views`.\n\n"
             "cycles: a list of int16 [transition, y, x], or an array [cycle, transition, y, x].\n"
             "views: orientation of the views: \"upright\", \"turned\", \"flipped-x\" or \"flipped-y\".");
  module.def(
      "event_picture",
      [](const py::array& images) {
        const auto counts = event_images_of(images, "images");
        return to_array(info::event_picture(owned(*counts)));
      },
      py::arg("images"),
      "Draws event images [transition, y, x] side by side as float32 [y, x, 3], ON events in red and OFF events in "
      "blue.");
}

}  // namespace

void bind_capture(py::module_& module) {
  bind_constants(module);
  bind_camera(module);
  bind_codes(module);
  bind_event_images(module);
}

}  // namespace e2lf::python
