// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "e2lf/recordings/recording.h"

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

/// The meaning of a column's name.
struct ColumnName {
  std::optional<Field> field = {};  ///< empty if the name is unknown
  TimeUnit unit = TimeUnit::kAuto;  ///< unit of times: "t_ns", "t (ns)", "timestampNs"
  bool is_xy = false;               ///< "xy": the column contains both coordinates
};

/// Parses a name in any case: "x", "xs", "event_timestamps", "Timestamp [us]", "polarity". A name with further words is
/// unknown: "t_offset", "t (100 ns)".
[[nodiscard]] ColumnName parse_column_name(std::string_view name);

/// The index of the column of each field, by Field, as far as it is known.
using KnownColumns = std::array<std::optional<size_t>, kNumFields>;

/// Returns for each field the column that its name denotes, or nothing if no name or several do.
[[nodiscard]] KnownColumns find_fields(std::span<const std::string> names);

/// Returns whether all fields have a column.
[[nodiscard]] bool are_complete(const KnownColumns& columns);

/// Parses "us", "usec", "microseconds" and the like in lower case; returns kAuto for other words.
[[nodiscard]] TimeUnit parse_time_unit(std::string_view word);

/// Returns the duration of a unit in microseconds; kAuto is microseconds.
[[nodiscard]] double us_per(TimeUnit unit);

/// Returns "s", "ms", "us" or "ns".
[[nodiscard]] const char* time_unit_name(TimeUnit unit);

}  // namespace e2lf::recordings::table
