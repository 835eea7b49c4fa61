// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

namespace e2lf::recordings::table {

/// A number of an event.
enum class Field : size_t { kX, kY, kP, kT };
inline constexpr size_t kNumFields = 4;

/// Returns the index of a field, below kNumFields.
constexpr size_t of(Field field) {
  return static_cast<size_t>(field);
}

/// The letters by which orders of columns are written, by field.
inline constexpr std::string_view kFieldLetters = "xypt";

}  // namespace e2lf::recordings::table
