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

/// A callable of Python for progress, progress(done, total), or None.
using ProgressArgument = std::optional<std::function<void(size_t, size_t)>>;

/// That as the library calls it, ten times a second at most, and at the end. It also looks for Ctrl-C. What is raised
/// there ends the work: the library passes exceptions of its callbacks on.
[[nodiscard]] ProgressFn progress_of(const ProgressArgument& progress);

/// An object that one thread may use at a time: two calls at once are a RuntimeError, not a race.
class OneAtATime {
 public:
  class Use {
   public:
    /// `what` goes into the message: "recording".
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

/// Lets Ctrl-C end the wait for a live recording while it exists: Python only notes signals until C++ returns.
class StopOnInterrupt {
 public:
  explicit StopOnInterrupt(bool is_live);
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

 private:
  bool is_installed_;
};

/// Raises KeyboardInterrupt, or whatever the program's handler of a signal raises, where one came.
void check_signals();

}  // namespace e2lf::python
