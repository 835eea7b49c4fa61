// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"

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

/// Adds e2lf.Error to the module; ResultError is translated to it, and ContractError to ValueError.
void bind_errors(py::module_& module);

}  // namespace e2lf::python
