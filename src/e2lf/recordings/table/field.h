// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

namespace e2lf::recordings::table {

/// The fields of an event.
enum class Field : size_t { kX, kY, kP, kT };
inline constexpr size_t kNumFields = 4;

/// Returns the index of a field, below kNumFields.
constexpr size_t of(Field field) {
  return static_cast<size_t>(field);
}

/// The letters of the fields in column orders.
inline constexpr std::string_view kFieldLetters = "xypt";

}  // namespace e2lf::recordings::table
