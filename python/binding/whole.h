// SPDX-License-Identifier: MIT
#pragma once

#include <pybind11/pybind11.h>

namespace e2lf::python {

/// A number of things as an argument: an integer of Python that is not negative. A negative one raises ValueError with
/// one line, where T itself would raise TypeError with all signatures of the function.
template <typename T>
struct Whole {
  T value = 0;
  Whole() = default;
  Whole(T number) : value(number) {}
  operator T() const { return value; }
};

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
