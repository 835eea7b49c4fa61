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

/// The first rows of a table, and what its format states.
struct TableSample {
  struct Column {
    std::string name = {};            ///< as in the file; empty = none
    TimeUnit unit = TimeUnit::kAuto;  ///< if the file states it apart from the name
    std::vector<double> values = {};  ///< equally many in all columns
    bool is_integer = false;          ///< stored as integers, so that later values are integers, too
    bool is_single = false;           ///< stored as floating-point numbers of 32 bits
  };
  std::vector<Column> columns;
  bool is_ordered = true;                 ///< whether the columns have an order that an option can name
  std::string usual_order = {};           ///< order to use if the values permit several, e.g. "xypt"; empty = none
  TimeUnit usual_unit = TimeUnit::kAuto;  ///< unit of the format if it fixes the unit

  /// Returns the first value of a column after the sample for which `is_wanted` returns true, or nothing if there is
  /// none or it cannot be looked up. May be empty.
  using IsWanted = std::function<bool(double)>;
  std::function<Result<std::optional<double>>(size_t column, const IsWanted& is_wanted)> find_further = {};
};

/// How to read the rows of a table.
struct TableLayout {
  ColumnsOfFields columns = {};
  TimeUnit unit = TimeUnit::kMicroseconds;
  PolarityCode polarity;
};

/// Determines the columns, the unit of the times and the code of the polarities from the options, then from names and
/// units in the file, then from the values. Adds the result to `info`, with an assumption for what neither an option
/// nor a name states. Fails with kInvalidValue, naming the option, if they cannot be determined.
[[nodiscard]] Result<TableLayout> decide_layout(TableSample sample, const OpenOptions& options,
                                                const std::string& location, RecordingInfo& info);

/// Fails with kInvalidValue if options for tables are given although the format fixes what they specify.
[[nodiscard]] Result<void> refuse_table_options(const OpenOptions& options, const std::string& format,
                                                const std::string& location);

/// Fails with kFormat if most rows were not events, in which case the table was misunderstood or is none. `first_bad`
/// describes the position and content of the first such row.
[[nodiscard]] Result<void> require_mostly_events(uint64_t events, uint64_t bad, const RecordingInfo& info,
                                                 const std::string& first_bad, const std::string& location);

}  // namespace e2lf::recordings::table
