// SPDX-License-Identifier: MIT
// The texts of TypeErrors: pybind11 prints the values of all arguments, which may be arrays of millions of pixels.
#include <string>

#include "e2lf/base/text.h"
#include "python/binding/module.h"

namespace e2lf::python {
namespace {

/// What all functions of pybind11 in this module are called by.
PyCFunctionWithKeywords g_dispatch = nullptr;

std::string type_of(py::handle value) {
  const std::string name = py::type::handle_of(value).attr("__name__").cast<std::string>();
  if (!py::hasattr(value, "dtype") || !py::hasattr(value, "shape")) return name;
  return cat(name, "[", py::str(value.attr("dtype")).cast<std::string>(), ", ",
             py::str(value.attr("shape")).cast<std::string>(), "]");
}

std::string types_of(py::handle arguments, PyObject* keywords) {
  std::vector<std::string> types;
  for (const py::handle value : arguments) types.push_back(type_of(value));
  if (keywords != nullptr) {
    for (const auto& [name, value] : py::reinterpret_borrow<py::dict>(keywords)) {
      types.push_back(cat(py::str(name).cast<std::string>(), ": ", type_of(value)));
    }
  }
  return cat("(", join(types), ")");
}

PyObject* call(PyObject* self, PyObject* arguments, PyObject* keywords) {
  PyObject* const result = g_dispatch(self, arguments, keywords);
  if (result != nullptr || PyErr_ExceptionMatches(PyExc_TypeError) == 0) return result;
  const py::error_already_set raised;
  const std::string text = py::str(raised.value()).cast<std::string>();
  const size_t values = text.find("\nInvoked with: ");
  const std::string shown = values == std::string::npos
                                ? text
                                : cat(text.substr(0, values), "\nInvoked with: ", types_of(arguments, keywords));
  PyErr_SetString(PyExc_TypeError, shown.c_str());
  return nullptr;
}

void shorten(py::handle function) {
  PyObject* plain = function.ptr();
  if (PyInstanceMethod_Check(plain) != 0) plain = PyInstanceMethod_GET_FUNCTION(plain);
  if (PyCFunction_Check(plain) == 0) return;
  PyMethodDef* const definition = reinterpret_cast<PyCFunctionObject*>(plain)->m_ml;
  auto* const dispatch = reinterpret_cast<PyCFunctionWithKeywords>(reinterpret_cast<void*>(definition->ml_meth));
  if (dispatch == call) return;
  if (g_dispatch == nullptr) g_dispatch = dispatch;
  if (dispatch == g_dispatch) definition->ml_meth = reinterpret_cast<PyCFunction>(reinterpret_cast<void*>(call));
}

}  // namespace

void shorten_type_errors(const py::module_& module) {
  for (const auto& [name, value] : module.attr("__dict__").cast<py::dict>()) {
    shorten(value);
    if (!py::isinstance<py::type>(value)) continue;
    for (const py::handle item : value.attr("__dict__").attr("values")()) {
      shorten(py::hasattr(item, "__func__") ? item.attr("__func__") : py::reinterpret_borrow<py::object>(item));
    }
  }
}

}  // namespace e2lf::python
