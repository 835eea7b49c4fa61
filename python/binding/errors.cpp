// SPDX-License-Identifier: MIT
#include "python/binding/errors.h"

#include <algorithm>
#include <string>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/files/workspace.h"

namespace e2lf::python {
namespace {

/// Returns the Python arguments that correspond to a setting of the library.
const char* arguments_of(Setting setting) {
  switch (setting) {
    case Setting::kOverwrite:
      return "overwrite";
    case Setting::kInputFormat:
    case Setting::kOutputFormat:
      return "format";
    case Setting::kSensorSize:
      return "width, height";
    case Setting::kTimeUnit:
      return "time_unit";
    case Setting::kColumns:
      return "columns";
    case Setting::kStream:
      return "stream";
    case Setting::kShiftTime:
      return "shift_time";
    case Setting::kFilterPixels:
      return "filter_pixels";
    case Setting::kCodes:
      return "codes";
    case Setting::kWhite:
      return "white";
    case Setting::kLensletViews:
      return "lenslet_views";
    case Setting::kViews:
      return "views";
    case Setting::kNone:
    case Setting::kPort:
      return "";
  }
  return "";
}

constexpr const char* kErrorDoc =
    "Raised for bad data, and for files that cannot be read or written. The text has the form \"location: what went "
    "wrong; what to do\", as on the command line.\n\n"
    "code: the kind of error: \"not_found\", \"exists\", \"format\", \"truncated\", \"unsupported\", "
    "\"invalid_value\", \"shape\", \"io\", \"missing_dependency\", \"cancelled\" or \"internal\".\n"
    "message: what went wrong and what to do.\n"
    "location: the file and the place in it; empty if there is none.\n"
    "setting: the argument that fixes the error, e.g. \"overwrite\"; empty if there is none.";

/// Never destroyed, because Python may have ended before.
PyObject* g_error = nullptr;

void raise_error(const Error& error) {
  const std::string setting = arguments_of(error.setting);
  const std::string text = printable(without_workspaces(error.text())) + (setting.empty() ? "" : " (" + setting + ")");
  py::object raised = py::reinterpret_borrow<py::object>(g_error)(text);
  raised.attr("code") = error_code_name(error.code);
  raised.attr("message") = without_workspaces(error.message);
  raised.attr("location") = without_workspaces(error.location);
  raised.attr("setting") = setting;
  PyErr_SetObject(g_error, raised.ptr());
}

}  // namespace

size_t check_word(const std::string& word, const std::vector<std::string>& words, const char* argument) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<size_t>(found - words.begin());
  throw ResultError({ErrorCode::kInvalidValue, cat("there is no \"", word, "\"; give one of ", join(words)), argument});
}

void bind_errors(py::module_& module) {
  py::dict defaults;
  for (const char* name : {"code", "message", "location", "setting"}) defaults[name] = "";
  g_error = PyErr_NewExceptionWithDoc("e2lf.Error", kErrorDoc, PyExc_Exception, defaults.ptr());
  module.add_object("Error", g_error);
  py::register_exception_translator([](std::exception_ptr raised) {
    try {
      if (raised) std::rethrow_exception(raised);
    } catch (const ResultError& error) {
      raise_error(error.error());
    } catch (const ContractError& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    }
  });
}

}  // namespace e2lf::python
