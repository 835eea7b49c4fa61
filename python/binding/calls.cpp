// SPDX-License-Identifier: MIT
#include "python/binding/calls.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <mutex>
#include <string>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"

namespace e2lf::python {
namespace {

constexpr const char* kErrorDoc =
    "Raised for bad data, and for files that cannot be read or written. The text has the form \"location: what went "
    "wrong; what to do\", as on the command line.\n\n"
    "code: the kind of error: \"not_found\", \"exists\", \"format\", \"truncated\", \"unsupported\", "
    "\"invalid_value\", \"shape\", \"io\", \"missing_dependency\", \"cancelled\" or \"internal\".\n"
    "message: what went wrong and what to do.\n"
    "location: the file and the place in it; empty if there is none.\n"
    "option: the argument that the error is about, e.g. \"overwrite\"; empty if there is none.";

/// Never destroyed, because Python may have ended before.
PyObject* g_error = nullptr;

void raise_error(const Error& error) {
  const std::string text = printable(without_workspaces(error.text()));
  py::object raised = py::reinterpret_borrow<py::object>(g_error)(text);
  raised.attr("code") = error_code_name(error.code);
  raised.attr("message") = without_workspaces(error.message);
  raised.attr("location") = without_workspaces(error.location);
  raised.attr("option") = error.option;
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
  for (const char* name : {"code", "message", "location", "option"}) defaults[name] = "";
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

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kLeastPause = std::chrono::milliseconds(100);

/// The signal handler that Python had installed, and the number of waits that have replaced it.
struct sigaction g_before {};
std::mutex g_mutex;
int g_waits = 0;

void on_interrupt(int signal, siginfo_t* info, void* context) {
  request_stop(signal);
  if ((g_before.sa_flags & SA_SIGINFO) != 0) return g_before.sa_sigaction(signal, info, context);
  if (g_before.sa_handler != SIG_DFL && g_before.sa_handler != SIG_IGN) g_before.sa_handler(signal);
}

}  // namespace

ProgressFn progress_of(const ProgressArgument& progress) {
  return [progress, last = Clock::now() - kLeastPause](size_t done, size_t total) mutable {
    const auto now = Clock::now();
    if (now - last < kLeastPause && done != total) return;
    last = now;
    const py::gil_scoped_acquire acquire;
    check_signals();
    if (progress) (*progress)(done, total);
  };
}

OneAtATime::Use::Use(OneAtATime& object, const char* what) : object_(object) {
  if (!object.is_used_.exchange(true)) return;
  throw std::runtime_error(std::string("this ") + what + " is at work in another call; open one for each thread");
}

StopOnInterrupt::StopOnInterrupt(bool is_live) : is_installed_(is_live) {
  if (!is_live) return;
  const std::lock_guard lock(g_mutex);
  if (g_waits++ > 0) return;
  struct sigaction action {};
  action.sa_sigaction = on_interrupt;
  action.sa_flags = SA_SIGINFO;  // without SA_RESTART, so that a blocking read returns
  ::sigaction(SIGINT, &action, &g_before);
}

StopOnInterrupt::~StopOnInterrupt() {
  if (!is_installed_) return;
  const std::lock_guard lock(g_mutex);
  if (--g_waits > 0) return;
  ::sigaction(SIGINT, &g_before, nullptr);
  request_stop(0);
}

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace e2lf::python
