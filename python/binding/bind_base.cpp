// SPDX-License-Identifier: MIT
// Binds the functions and names of the module itself to Python.
#include <pybind11/stl.h>

#include "e2lf/base/isa.h"
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/info/version.h"
#include "python/binding/calls.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

/// Forwards messages to the logger "e2lf" of Python's logging.
void log_to_python(LogLevel level, const std::string& message) {
  const py::gil_scoped_acquire acquire;
  try {
    const char* const method = level == LogLevel::kWarning ? "warning" : "info";
    // Passed as an argument, because a message may contain "%".
    py::module_::import("logging").attr("getLogger")("e2lf").attr(method)("%s", message);
  } catch (py::error_already_set& error) {
    error.discard_as_unraisable("e2lf's log");  // the library cannot pass it on
  }
}

std::string path_or_throw(const std::optional<std::filesystem::path>& path, const std::string& message) {
  if (path) return path->string();
  PyErr_SetString(PyExc_FileNotFoundError, message.c_str());
  throw py::error_already_set();
}

void bind_bundled_files(py::module_& module) {
  module.def(
      "data_file",
      [](const std::string& name) {
        return path_or_throw(bundled_file(name), name +
                                                     " is not part of this installation of e2lf; give the path "
                                                     "of a file");
      },
      py::arg("name"),
      "Returns the path of a file that is distributed with e2lf.\n\n"
      "name: the name with its folder, such as \"models/e2lf-n4.safetensors\" or \"cameras/evk4-lcos.json\".");
  module.def(
      "bundled_model",
      [](const std::string& name) {
        return path_or_throw(
            bundled_file_named(kBundledModels, name),
            cat("there is no bundled model ", name, "; give one of ", join(bundled_names(kBundledModels))));
      },
      py::arg("name") = "e2lf-n4",
      "Returns the path of a bundled model; docs/models.md describes them. read_model() also accepts the name.\n\n"
      "name: the name of the model, such as \"e2lf-n4\", \"e2lf-n8\" or \"e2lf-n4-camera\".");
}

}  // namespace

void bind_base(py::module_& module) {
  module.attr("__version__") = info::kVersion;
  bind_bundled_files(module);
  take(apply_isa_cap());
  set_log_sink(log_to_python);
  py::module_::import("atexit").attr("register")(py::cpp_function([] { set_log_sink({}); }));

  module.def("num_threads", &num_threads, "Returns the number of threads that the library uses: all cores unless set.");
  module.def(
      "set_num_threads",
      [](int threads) {
        if (threads < 0) throw py::value_error("the number of threads cannot be negative; 0 is all cores");
        set_num_threads(threads);
      },
      py::arg("threads"), "Sets the number of threads of the whole process.\n\nthreads: 0 = all cores.");
  module.def("instruction_set", &current_isa,
             "Returns the instruction set of the kernels: \"scalar\", \"sse4\", \"avx2\", \"avx512\" or \"amx\". The "
             "environment variable E2LF_MAX_ISA limits it.");
}

}  // namespace e2lf::python
