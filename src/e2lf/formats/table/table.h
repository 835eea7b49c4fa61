// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::formats {
using namespace recordings;
}

namespace e2lf::formats::table {

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

/// Converts a number to To; returns true if it is not an integer or does not fit.
template <typename From, typename To>
bool convert_one(From value, To& out) {
  if constexpr (std::is_floating_point_v<From>) {
    const auto number = static_cast<double>(value);
    const bool fits = number == std::trunc(number) && number >= static_cast<double>(std::numeric_limits<To>::min()) &&
                      number < std::ldexp(1.0, std::numeric_limits<To>::digits);
    out = fits ? static_cast<To>(number) : To{};
    return !fits;
  } else {
    out = static_cast<To>(value);
    return (value < From{0} && std::is_unsigned_v<To>) ||
           (static_cast<uint64_t>(value) > static_cast<uint64_t>(std::numeric_limits<To>::max()) && value > From{0});
  }
}

/// Converts a time to microseconds, rounded (integral nanoseconds are rounded down); returns true if it is beyond
/// kTimeLimitUs.
template <typename From>
bool convert_time(From value, TimeUnit unit, int64_t& out) {
  if constexpr (std::is_floating_point_v<From>) {
    const double us = static_cast<double>(value) * us_per(unit);
    const bool fits = std::fabs(us) <= static_cast<double>(kTimeLimitUs);
    out = fits ? static_cast<int64_t>(std::llround(us)) : 0;
    return !fits;
  } else {
    if (convert_one(value, out)) return true;
    if (unit == TimeUnit::kNanoseconds) {
      out = out / 1000 - (out % 1000 < 0 ? 1 : 0);
      return false;
    }
    const auto factor = static_cast<int64_t>(us_per(unit));
    return factor != 1 && __builtin_mul_overflow(out, factor, &out);
  }
}

/// The first rows of a table, and what its format states.
struct TableSample {
  struct Column {
    std::string name = {};            ///< as in the file; empty = none
    std::vector<double> values = {};  ///< equally many in all columns
    TimeUnit unit = TimeUnit::kAuto;  ///< if the file states it apart from the name
    bool is_fraction = false;         ///< whether the values are known to be fractions, however they look
    int mantissa_bits = 0;            ///< of numbers that are stored as floating-point numbers; 0 = others
  };
  std::vector<Column> columns = {};
  bool is_ordered = true;           ///< whether the columns have an order that an option can name
  std::string order = {};           ///< order that the format defines for columns without names, e.g. "xypt"
  TimeUnit unit = TimeUnit::kAuto;  ///< unit that the format defines
};

/// The index of the column of each field, by Field.
using ColumnsOfFields = std::array<size_t, kNumFields>;

/// The code of polarities in a table.
struct PolarityCode {
  double off = 0, off_too = -1, on = 1;

  static constexpr uint8_t kNone = 2;
  /// Returns 1 (ON), 0 (OFF), or kNone for a value that is neither.
  [[nodiscard]] uint8_t of(double value) const {
    return value == on ? 1 : value == off || value == off_too ? 0 : kNone;
  }
};

/// How to read the rows of a table.
struct TableLayout {
  ColumnsOfFields columns = {};
  TimeUnit unit = TimeUnit::kMicroseconds;
  PolarityCode polarity;
};

/// Determines the columns, the unit of the times and the code of the polarities, and adds them to `info`:
/// - the columns from the options, from their names, or as the format defines them. Four columns without names are t,
///   x, y, p if the first contains fractions.
/// - the unit from the options, from the file, or as the format defines it. Whole numbers without a unit are
///   microseconds, and fractions are seconds.
/// - the polarities from the options, or 0/1 or -1/1.
/// Fails with kInvalidValue or kUnsupported and names the setting if that does not suffice, if coordinates are
/// fractions or larger than any sensor, or if the times are stored too coarsely.
[[nodiscard]] Result<TableLayout> decide_layout(const TableSample& sample, const OpenOptions& options,
                                                const std::string& location, RecordingInfo& info);

/// Fails with kFormat if most rows were not events, in which case the table was misunderstood or is none. `first_bad`
/// describes the position and content of the first such row.
[[nodiscard]] Result<void> require_mostly_events(uint64_t events, uint64_t bad, const RecordingInfo& info,
                                                 const std::string& first_bad, const std::string& location);

/// The position of one field of an event in records that are `stride` bytes apart; a separate column has offset 0.
struct NumberField {
  std::string type;  ///< numpy code: "u1".."u8", "i1".."i8", "b1", "f2".."f8"
  size_t offset = 0;
  size_t stride = 0;
};

/// A column of a table: a field of records.
struct NumberColumn {
  const uint8_t* records = nullptr;
  NumberField field = {};
};

/// Returns whether to_column() reads a type.
[[nodiscard]] bool is_number_type(const std::string& type);

/// Converts the first `count` numbers of a column to T. Sets bad[i] for values that do not fit or are not integers.
template <typename T>
void to_column(const NumberColumn& column, size_t count, T* out, uint8_t* bad);

/// Converts times to microseconds, rounded (integral nanoseconds are rounded down). kAuto is microseconds. Sets bad[i]
/// for times beyond kTimeLimitUs.
void to_times(const NumberColumn& column, TimeUnit unit, size_t count, int64_t* out, uint8_t* bad);

/// Replaces `events` by those of `count` rows, and returns the number of rows that are not events.
size_t to_events(std::span<const NumberColumn> columns, const TableLayout& layout, size_t count, EventColumns& events);

/// Returns the first `count` numbers of a column as doubles.
[[nodiscard]] std::vector<double> to_doubles(const NumberColumn& column, size_t count);

/// Returns the sample of a column of `count` rows that has a name.
[[nodiscard]] TableSample::Column sample_of(std::string name, const NumberColumn& column, size_t count);

/// Sets the size of the sensor from what numbers(name) returns for `size` [width, height], `sensor_resolution` [height,
/// width], or `width` and `height`. Returns false if none of them is a size, which does not change `info`.
bool read_sensor_size(const std::function<std::vector<double>(const char* name)>& numbers, RecordingInfo& info);

/// Number of rows from which columns, units and polarities are determined.
inline constexpr size_t kSampledRows = 4096;

}  // namespace e2lf::formats::table
