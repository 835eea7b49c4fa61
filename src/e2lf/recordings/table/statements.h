// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

#include "e2lf/recordings/table/time_units.h"

/// What the sentences of a header state about the columns of a table.
namespace e2lf::recordings::table {

struct TimeStatement {
  TimeUnit unit = TimeUnit::kAuto;  ///< unit of the times: "timestamps are in us", "ts_unit: ns"
  double tick_s = 0;                ///< duration of one count: "resolution: 1 ns", "ticks per second: 1e6"; 0 = unknown
};

/// Finds the statement about times in a text. Statements about other durations ("exposure time: 10 ms") are ignored.
[[nodiscard]] TimeStatement times_in_sentence(std::string_view text);

/// The numbers of ON and OFF events: "0 = ON, 1 = OFF", "1 means OFF", "polarity(off/on=0/1)".
struct PolarityStatement {
  std::optional<double> on, off;
};
[[nodiscard]] PolarityStatement polarities_in_sentence(std::string_view text);

}  // namespace e2lf::recordings::table
