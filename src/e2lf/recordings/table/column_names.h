// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/table/field.h"

namespace e2lf::recordings::table {

/// What the name of a column says.
struct ColumnName {
  std::optional<Field> field;       ///< nothing for a name that is not known
  TimeUnit unit = TimeUnit::kAuto;  ///< of times: "t_ns", "t (ns)", "timestampNs"; known of unknown names, too
  bool is_xy = false;               ///< "xy": the column holds both coordinates
  size_t rank = 0;                  ///< of two columns of one field the lower is meant
};

/// Reads a name in any case, quoted or not, with the prefix "event" or without: "x", "xs", "Timestamp [us]",
/// "polarity".
[[nodiscard]] ColumnName parse_column_name(std::string_view name);

/// "us", "usec", "microseconds" and the like; kAuto for other words.
[[nodiscard]] TimeUnit parse_time_unit(std::string_view word);

/// "s", "ms", "us" or "ns".
[[nodiscard]] const char* time_unit_name(TimeUnit unit);

/// The unit that a sentence gives to times ("timestamps are in us"); kAuto where it says none.
[[nodiscard]] TimeUnit unit_in_sentence(std::string_view text);

}  // namespace e2lf::recordings::table
