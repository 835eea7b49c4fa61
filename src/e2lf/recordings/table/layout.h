// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/table/column_order.h"
#include "e2lf/recordings/table/polarity.h"

namespace e2lf::recordings::table {

/// The first rows of a table, and what its format says of it.
struct TableSample {
  struct Column {
    std::string name = {};            ///< as the file has it; empty = none
    TimeUnit unit = TimeUnit::kAuto;  ///< where the file says it apart from the name
    std::vector<double> values = {};  ///< as many in all columns
    bool is_integer = false;          ///< stored without a point: further on there are whole numbers, too
  };
  std::vector<Column> columns;
  bool is_ordered = true;                 ///< the columns have an order that an option can name
  std::string usual_order = {};           ///< where the values leave several, as "xypt"; empty = none
  TimeUnit usual_unit = TimeUnit::kAuto;  ///< of the format, where it is one that fixes the unit

  /// The first value of a column behind the sample for which `is_wanted`; nothing where there is none or where that
  /// cannot be looked up. May be empty.
  using IsWanted = std::function<bool(double)>;
  std::function<Result<std::optional<double>>(size_t column, const IsWanted& is_wanted)> find_further = {};
};

/// How the rows of a table are to be read.
struct TableLayout {
  ColumnsOfFields columns = {};
  TimeUnit unit = TimeUnit::kMicroseconds;
  PolarityCode polarity;
};

/// Decides the columns, the unit of the times and the code of the polarities: by the options, then by names and units
/// in the file, then by the values. Adds to `info` what was decided, and in one line what no option and no name said.
/// Fails with kInvalidValue where it cannot be decided, and names the option.
[[nodiscard]] Result<TableLayout> decide_layout(TableSample sample, const OpenOptions& options,
                                                const std::string& location, RecordingInfo& info);

/// Fails with kInvalidValue where options are given that are for tables: the format fixes what they say.
[[nodiscard]] Result<void> refuse_table_options(const OpenOptions& options, const std::string& format,
                                                const std::string& location);

/// Fails with kFormat where most rows were no events: then the table was misunderstood, or is none. `first_bad` says
/// where the first of them is and what it holds.
[[nodiscard]] Result<void> require_mostly_events(uint64_t events, uint64_t bad, const RecordingInfo& info,
                                                 const std::string& first_bad, const std::string& location);

}  // namespace e2lf::recordings::table
