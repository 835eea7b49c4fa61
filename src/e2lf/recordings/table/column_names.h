// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/table/field.h"

namespace e2lf::recordings::table {

/// The meaning of a column's name.
struct ColumnName {
  std::optional<Field> field;       ///< empty if the name is unknown
  TimeUnit unit = TimeUnit::kAuto;  ///< unit of times: "t_ns", "t (ns)", "timestampNs"; also known for unknown names
  bool is_xy = false;               ///< "xy": the column contains both coordinates
  size_t rank = 0;                  ///< of two columns for one field, the one with the lower rank is used
};

/// Parses a name in any case, with or without quotes and the prefix "event": "x", "xs", "Timestamp [us]", "polarity".
[[nodiscard]] ColumnName parse_column_name(std::string_view name);

/// Parses "us", "usec", "microseconds" and the like; returns kAuto for other words.
[[nodiscard]] TimeUnit parse_time_unit(std::string_view word);

/// Returns "s", "ms", "us" or "ns".
[[nodiscard]] const char* time_unit_name(TimeUnit unit);

/// Returns the unit of times in a sentence ("timestamps are in us"), or kAuto if it states none.
[[nodiscard]] TimeUnit unit_in_sentence(std::string_view text);

}  // namespace e2lf::recordings::table
