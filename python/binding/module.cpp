// SPDX-License-Identifier: MIT
// The module e2lf._e2lf; python/e2lf/__init__.py lists its public names.
#include "python/binding/module.h"

#include "e2lf/cameras/cameras.h"
#include "e2lf/files/options.h"
#include "e2lf/formats/formats.h"
#include "e2lf/video/operations.h"
#include "python/binding/calls.h"

namespace e2lf::python {

py::object to_python(const Json& json) {
  return py::module_::import("json").attr("loads")(json_line(json));
}

Json from_python(const py::object& value) {
  return take(parse_json(py::module_::import("json").attr("dumps")(value).cast<std::string>(), "value"));
}

}  // namespace e2lf::python

PYBIND11_MODULE(_e2lf, module) {
  namespace python = e2lf::python;
  e2lf::formats::add_formats();
  e2lf::cameras::add_cameras();
  e2lf::video::add_operations();  // any model may have them
  python::add_torch_devices();
  python::bind_errors(module);
  python::bind_base(module);
  python::bind_capture(module);
  python::bind_recordings(module);
  python::bind_writers(module);
  python::bind_cycles(module);
  python::bind_lightfield(module);
  python::bind_sensor(module);
  python::bind_model(module);
  python::bind_recon(module);
  python::bind_eval(module);
  python::bind_depth(module);
  python::bind_calibrate(module);
  python::bind_video(module);
  python::shorten_type_errors(module);
}
