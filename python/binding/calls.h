// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "e2lf/base/progress.h"
#include "python/binding/errors.h"

namespace e2lf::python {

/// Runs `work`, which returns a Result, while other threads of Python run. Returns its value or throws its error.
template <typename Work>
auto without_gil(const Work& work) {
  auto result = [&work] {
    const py::gil_scoped_release release;
    return work();
  }();
  return take(std::move(result));
}

/// A Python callable for the progress, progress(done, total), or None.
using ProgressArgument = std::optional<std::function<void(size_t, size_t)>>;

/// Returns a callback for the library that calls it at most ten times a second and at the end, and also checks for
/// Ctrl-C. Exceptions raised there cancel the operation, because the library propagates exceptions of callbacks.
[[nodiscard]] ProgressFn progress_of(const ProgressArgument& progress);

/// An object that may be used by one thread at a time: concurrent calls raise RuntimeError instead of being a data
/// race.
class OneAtATime {
 public:
  class Use {
   public:
    /// `what` names the object in the message, e.g. "recording".
    Use(OneAtATime& object, const char* what);
    ~Use() { object_.is_used_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    OneAtATime& object_;
  };

 private:
  std::atomic<bool> is_used_ = false;
};

/// While it exists, Ctrl-C ends the wait for a live recording; otherwise, Python only notes signals until C++ returns.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(bool is_live);
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

 private:
  bool is_installed_;
};

/// Raises KeyboardInterrupt, or the exception of the program's signal handler, if a signal has arrived.
void check_signals();

}  // namespace e2lf::python
