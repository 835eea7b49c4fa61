// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/table/column_order.h"
#include "e2lf/recordings/table/polarity.h"
#include "e2lf/recordings/table/statements.h"

namespace e2lf::recordings::table {

/// The first rows of a table, and what its format states.
struct TableSample {
  struct Column {
    std::string name = {};            ///< as in the file; empty = none
    TimeUnit unit = TimeUnit::kAuto;  ///< if the file states it apart from the name
    std::vector<double> values = {};  ///< equally many in all columns
    bool is_integer = false;          ///< stored as integers, so that later values are integers, too
    bool is_single = false;           ///< stored as floating-point numbers of 32 bits
    double step = 0;                  ///< smallest difference of large values as they are written; 0 = unknown
  };
  double tick_s = 0;                  ///< duration of one count of times that are integers, if the file states it, or 0
  PolarityStatement polarities = {};  ///< if the file states it
  std::vector<Column> columns;
  bool is_ordered = true;                 ///< whether the columns have an order that an option can name
  std::string usual_order = {};           ///< order to use if the values permit several, e.g. "xypt"; empty = none
  TimeUnit usual_unit = TimeUnit::kAuto;  ///< unit of the format if it fixes the unit

  /// Returns the values of a column in the next rows after the sample, or none at the end. Begins with the first of
  /// these rows if `is_first`, which is set in the first call for a column. Empty if rows cannot be looked up.
  std::function<Result<std::vector<double>>(size_t column, bool is_first)> more_values = {};
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

/// Checks the size of the sensor that a header states against the coordinates of a sample. If many lie outside, it is
/// transposed if that helps, or otherwise ignored, because it is the size of something else.
void check_stated_size(const TableSample& sample, const TableLayout& layout, const std::string& location,
                       RecordingInfo& info);

/// Fails with kInvalidValue if options for tables are given although the format fixes what they specify.
[[nodiscard]] Result<void> refuse_table_options(const OpenOptions& options, const std::string& format,
                                                const std::string& location);

/// Fails with kFormat if most rows were not events, in which case the table was misunderstood or is none. `first_bad`
/// describes the position and content of the first such row.
[[nodiscard]] Result<void> require_mostly_events(uint64_t events, uint64_t bad, const RecordingInfo& info,
                                                 const std::string& first_bad, const std::string& location);

}  // namespace e2lf::recordings::table
