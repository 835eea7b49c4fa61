// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/table/time_units.h"

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
  std::optional<Field> field;       ///< empty if the name is unknown
  TimeUnit unit = TimeUnit::kAuto;  ///< unit of times: "t_ns", "t (ns)", "timestampNs"; also known for unknown names
  double tick_s = 0;                ///< the same in seconds, also for other units: "t (100 ns)"; 0 = not stated
  bool is_xy = false;               ///< "xy": the column contains both coordinates
  size_t rank = 0;                  ///< of two columns for one field, the one with the lower rank is used
};

/// The index of the column of each field, by Field, as far as it is known.
using KnownColumns = std::array<std::optional<size_t>, kNumFields>;

/// Returns for each field the column whose name denotes it best.
[[nodiscard]] KnownColumns find_fields(std::span<const std::string> names);

/// Parses a name in any case, with or without quotes and the prefix "event": "x", "xs", "Timestamp [us]", "polarity
/// (0 = OFF)", "time_ms_since_start".
[[nodiscard]] ColumnName parse_column_name(std::string_view name);

}  // namespace e2lf::recordings::table
