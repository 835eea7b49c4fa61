// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/output.h"

/// What every call from Python needs: errors, words and numbers as arguments, the lock of Python, progress, signals and
/// outputs.
namespace e2lf::python {

namespace py = pybind11;

/// An exception that carries an Error to Python, where it becomes e2lf.Error.
class ResultError : public std::runtime_error {
 public:
  explicit ResultError(Error error) : std::runtime_error(error.message), error_(std::move(error)) {}
  [[nodiscard]] const Error& error() const { return error_; }

 private:
  Error error_;
};

/// Returns the value of a result, or throws its error.
template <typename T>
T take(Result<T> result) {
  if (!result) throw ResultError(result.error());
  return std::move(result).value();
}
inline void take(const Result<void>& result) {
  if (!result) throw ResultError(result.error());
}

/// Returns the number of `word` among `words`. Fails with kInvalidValue if it is none of them; `argument` is the
/// location.
size_t check_word(const std::string& word, const std::vector<std::string>& words, const char* argument);

/// Returns the value of `word` among `words`. Fails as check_word() does.
template <typename T, size_t kCount>
T value_of(const std::string& word, const Choice<T> (&words)[kCount], const char* argument) {
  return words[check_word(word, words_of(words), argument)].value;
}

/// Adds e2lf.Error to the module; ResultError is translated to it, and ContractError to ValueError.
void bind_errors(py::module_& module);

/// A number of things as an argument: an integer of Python that is not negative. A negative one raises ValueError with
/// one line, where T itself would raise TypeError with all signatures of the function.
template <typename T>
struct Whole {
  T value = 0;
  Whole() = default;
  Whole(T number) : value(number) {}
  operator T() const { return value; }
};

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

/// Writes a file that appears complete, by the rules of the verbs: an existing file is replaced only if `overwrite` is
/// set. `write` receives the path to write to and returns a Result. Runs without the GIL.
template <typename Write>
void write_output(const std::filesystem::path& path, bool overwrite, const Write& write) {
  without_gil([&]() -> Result<void> {
    E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(path, {.overwrite = overwrite}));
    E2LF_RETURN_IF_ERROR(write(output.path()));
    return output.commit();
  });
}

}  // namespace e2lf::python

namespace pybind11::detail {

template <typename T>
struct type_caster<e2lf::python::Whole<T>> {
  PYBIND11_TYPE_CASTER(e2lf::python::Whole<T>, const_name("int"));

  bool load(handle source, bool convert) {
    make_caster<T> whole;
    if (whole.load(source, convert)) {
      value = cast_op<T>(whole);
      return true;
    }
    make_caster<long long> number;
    if (!number.load(source, convert) || cast_op<long long>(number) >= 0) return false;
    throw value_error(std::to_string(cast_op<long long>(number)) + " is negative; give 0 or more");
  }

  static handle cast(const e2lf::python::Whole<T>& whole, return_value_policy policy, handle parent) {
    return make_caster<T>::cast(whole.value, policy, parent);
  }
};

}  // namespace pybind11::detail
