// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/layout.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/log.h"
#include "e2lf/base/median.h"
#include "e2lf/base/printable.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/table/column_names.h"

namespace e2lf::recordings::table {
namespace {

/// The origin of the interpretation of a part of a table.
enum class Reason { kOption, kFile, kFormat, kValues };

const char* reason_text(Reason reason) {
  switch (reason) {
    case Reason::kOption:
      return "as the option says";
    case Reason::kFile:
      return "as the file says";
    case Reason::kFormat:
      return "as usual in this format";
    case Reason::kValues:
      break;
  }
  return "by their values";
}

Error undecided(std::string message, const std::string& location, Setting setting) {
  return {ErrorCode::kInvalidValue, std::move(message), location, setting};
}

Result<ColumnsOfFields> order_of_option(const std::string& order, const TableSample& sample,
                                        const std::string& location) {
  if (!sample.is_ordered) {
    return undecided("the columns are identified by names, so they have no order; leave the option out", location,
                     Setting::kColumns);
  }
  ColumnsOfFields columns = {};
  bool fits = order.size() == sample.columns.size();
  for (size_t field = 0; field < kNumFields; ++field) {
    const size_t place = order.find(kFieldLetters[field]);
    fits = fits && place != std::string::npos && order.find(kFieldLetters[field], place + 1) == std::string::npos;
    columns[field] = place;
  }
  fits = fits && order.find_first_not_of("xypt-") == std::string::npos;
  if (fits) return columns;
  return undecided(cat("\"", order, "\" is not an order of the ", sample.columns.size(),
                       " columns; write each of t, x, y, p once, e.g. txyp, and - for a column to skip"),
                   location, Setting::kColumns);
}

/// Returns the names of the columns in brackets, or nothing if they have none.
std::string names_text(const TableSample& sample) {
  constexpr size_t kMost = 10;
  std::vector<std::string> names;
  for (const TableSample::Column& column : sample.columns) {
    if (names.size() < kMost) names.push_back(printable(column.name));
  }
  if (std::all_of(names.begin(), names.end(), [](const std::string& name) { return name.empty(); })) return "";
  return cat(" (", join(names), sample.columns.size() > kMost ? ", ...)" : ")");
}

/// Fails if times are in two columns, as ROS has them: whole seconds, and the nanoseconds after them.
Result<void> refuse_split_times(const TableSample& sample, std::optional<size_t> times, const std::string& location) {
  if (!times || parse_column_name(sample.columns[*times].name).unit != TimeUnit::kSeconds) return {};
  const auto are_whole = [](const TableSample::Column& column, double most) {
    return std::all_of(column.values.begin(), column.values.end(),
                       [most](double value) { return value == std::trunc(value) && value < most; });
  };
  for (const TableSample::Column& column : sample.columns) {
    const ColumnName name = parse_column_name(column.name);
    if (name.unit != TimeUnit::kNanoseconds || !are_whole(column, 1e9) || !are_whole(sample.columns[*times], 1e18)) {
      continue;
    }
    return undecided(cat("the times are in two columns, seconds (", printable(sample.columns[*times].name),
                         ") and the nanoseconds after them (", printable(column.name),
                         "); join them to one of "
                         "nanoseconds, or name a column that holds the whole time"),
                     location, Setting::kColumns);
  }
  return {};
}

struct Columns {
  ColumnsOfFields columns = {};
  Reason reason = Reason::kFile;
};

Result<Columns> decide_columns(const TableSample& sample, const OpenOptions& options, const RecordingInfo& info,
                               const std::string& location) {
  if (!options.columns.empty()) {
    E2LF_ASSIGN_OR_RETURN(const ColumnsOfFields columns, order_of_option(options.columns, sample, location));
    return Columns{columns, Reason::kOption};
  }
  std::array<std::optional<size_t>, kNumFields> named;
  std::array<size_t, kNumFields> ranks{};
  for (size_t i = 0; i < sample.columns.size(); ++i) {
    const ColumnName name = parse_column_name(sample.columns[i].name);
    if (!name.field) continue;
    const size_t field = of(*name.field);
    if (named[field] && ranks[field] <= name.rank) continue;
    named[field] = i;
    ranks[field] = name.rank;
  }
  E2LF_RETURN_IF_ERROR(refuse_split_times(sample, named[of(Field::kT)], location));
  if (std::all_of(named.begin(), named.end(), [](const auto& column) { return column.has_value(); })) {
    return Columns{{*named[0], *named[1], *named[2], *named[3]}, Reason::kFile};
  }
  const Error error =
      undecided(cat("neither names nor values determine which of the ", sample.columns.size(), " columns",
                    names_text(sample), " are t, x, y and p; give their order, e.g. ",
                    std::string("txyp-----").substr(0, sample.columns.size()), ", or check whether these are events"),
                location, Setting::kColumns);
  if (sample.columns.size() != kNumFields) return error;
  OrderHints hints{{}, info.width, info.height, sample.usual_order};
  for (size_t field = 0; field < kNumFields; ++field) {
    if (named[field]) hints.named[*named[field]] = static_cast<Field>(field);
  }
  std::vector<std::vector<double>> values;
  for (const TableSample::Column& column : sample.columns) values.push_back(column.values);
  if (values[0].empty() && hints.usual.empty()) hints.usual = "txyp";  // of no event
  const auto guess = find_order(values, hints);
  if (!guess) return error;
  return Columns{guess->columns, guess->is_usual ? Reason::kFormat : Reason::kValues};
}

/// Returns the unit of times that are not integers, or nothing if they are unlikely to be seconds.
std::optional<TimeUnit> unit_of_fractions(const std::vector<double>& times) {
  constexpr double kLatestS = 1e11;  // 3,000 years
  constexpr size_t kManyEvents = 100;
  std::vector<double> sizes;
  for (const double time : times) sizes.push_back(std::fabs(time));
  const double middle = median(std::move(sizes));
  if (middle >= kLatestS * 1e6) return TimeUnit::kNanoseconds;
  if (middle >= kLatestS * 1e3) return TimeUnit::kMicroseconds;
  if (middle >= kLatestS) return TimeUnit::kMilliseconds;
  const double span_s = std::fabs(times.back() - times.front());
  if (times.size() >= kManyEvents && span_s > static_cast<double>(times.size())) return std::nullopt;
  return TimeUnit::kSeconds;
}

/// If the times of the sample have a single value, which is not conclusive, adds a later one.
Result<void> complete_times(TableSample& sample, size_t column) {
  TableSample::Column& times = sample.columns[column];
  const auto is_zero = [](double time) { return time == 0; };
  if (times.is_integer || !sample.find_further || !std::all_of(times.values.begin(), times.values.end(), is_zero)) {
    return {};
  }
  E2LF_ASSIGN_OR_RETURN(const auto other, sample.find_further(column, [](double time) { return time != 0; }));
  if (other) times.values.assign(1, *other);
  return {};
}

struct Unit {
  TimeUnit unit = TimeUnit::kMicroseconds;
  Reason reason = Reason::kFile;
  const char* why = "";
};

Result<Unit> decide_unit(TableSample& sample, size_t column, const OpenOptions& options, const std::string& location) {
  constexpr double kLatestUs = 1e17;  // 3,000 years: larger ones are nanoseconds since 1970
  if (options.time_unit != TimeUnit::kAuto) return Unit{options.time_unit, Reason::kOption};
  TableSample::Column& times = sample.columns[column];
  if (times.unit != TimeUnit::kAuto) return Unit{times.unit};
  if (const TimeUnit named = parse_column_name(times.name).unit; named != TimeUnit::kAuto) return Unit{named};
  if (sample.usual_unit != TimeUnit::kAuto) return Unit{sample.usual_unit, Reason::kFormat};
  E2LF_RETURN_IF_ERROR(complete_times(sample, column));
  size_t set = 0, fractions = 0, large = 0;
  for (const double time : times.values) {
    set += time != 0;
    fractions += time != std::trunc(time);
    large += std::fabs(time) >= kLatestUs;
  }
  // A few values may be damaged.
  if (fractions > 0 && 10 * fractions >= set) {
    if (const auto unit = unit_of_fractions(times.values)) return Unit{*unit, Reason::kValues, "not whole numbers"};
    return undecided("the times are not integers, but too far apart to be seconds; give their unit", location,
                     Setting::kTimeUnit);
  }
  const bool are_ns = 2 * large > times.values.size();
  return Unit{are_ns ? TimeUnit::kNanoseconds : TimeUnit::kMicroseconds, Reason::kValues,
              are_ns ? "too large for us" : "whole numbers"};
}

struct Polarity {
  PolarityCode code;
  std::string warning;  ///< remaining doubt
};

std::string values_text(const std::vector<double>& values) {
  std::vector<double> distinct(values);
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  constexpr size_t kMost = 4;
  std::vector<std::string> texts;
  for (size_t i = 0; i < std::min(kMost, distinct.size()); ++i) texts.push_back(cat(distinct[i]));
  return join(texts) + (distinct.size() > kMost ? ", ..." : "");
}

Result<Polarity> decide_polarity(TableSample& sample, size_t column, const std::string& location) {
  std::vector<double>& values = sample.columns[column].values;
  PolarityGuess guess = guess_polarity(values);
  if (10 * guess.explained < 9 * values.size()) {
    return undecided(
        cat("the polarities of column ", column + 1, " are ", values_text(values),
            "; supported are 0/1, -1/1, 1/2, 0/255, true/false and on/off; check which column contains them"),
        location, Setting::kColumns);
  }
  if (guess.has_off != guess.has_on && sample.find_further) {
    const double known = guess.has_on ? guess.code.on : guess.code.off;
    const auto is_other = [known](double value) { return value != known && is_polarity(value); };
    E2LF_ASSIGN_OR_RETURN(const auto other, sample.find_further(column, is_other));
    // As often as the other one, so that neither is an exception.
    if (other) values.insert(values.end(), values.size(), *other);
    guess = guess_polarity(values);
  }
  Polarity polarity{guess.code, ""};
  if (guess.has_on && !guess.has_off) polarity.warning = ", and there is no other polarity";
  return polarity;
}

/// Warns about values that are read unchanged but are implausible: times that 32 bits do not resolve, and coordinates
/// beyond any sensor.
void warn_of_values(const TableSample& sample, const TableLayout& layout, const RecordingInfo& info,
                    const std::string& location) {
  constexpr double kCoarseUs = 10, kWidestPx = 8192;
  const auto most_of = [](const TableSample::Column& column) {
    return column.values.empty() ? 0 : *std::max_element(column.values.begin(), column.values.end());
  };
  const TableSample::Column& times = sample.columns[layout.columns[of(Field::kT)]];
  const double us_per_unit = layout.unit == TimeUnit::kSeconds        ? 1e6
                             : layout.unit == TimeUnit::kMilliseconds ? 1e3
                             : layout.unit == TimeUnit::kNanoseconds  ? 1e-3
                                                                      : 1;
  const double last = most_of(times);
  const double step_us = std::ldexp(1.0, std::ilogb(std::max(last, 1e-9)) - 23) * us_per_unit;
  if (times.is_single && step_us > kCoarseUs) {
    log_warning(cat(location, ": the times are floating-point numbers of 32 bits, which are ", step_us, " us apart at ",
                    last, " ", time_unit_name(layout.unit), "; store them as integers or with 64 bits"));
  }
  const double most_px = std::max(most_of(sample.columns[layout.columns[of(Field::kX)]]),
                                  most_of(sample.columns[layout.columns[of(Field::kY)]]));
  if (info.width == 0 && most_px >= kWidestPx) {
    log_warning(cat(location, ": the coordinates reach ", most_px,
                    " px, more than any sensor has; if they are fractions of pixels (BS-ERGB stores 1/32 px), divide "
                    "them first"));
  }
}

std::string columns_text(const TableSample& sample, const ColumnsOfFields& columns) {
  std::array<std::pair<size_t, std::string>, kNumFields> parts;
  for (size_t field = 0; field < kNumFields; ++field) {
    parts[field] = {sample.is_ordered ? columns[field] : field, std::string(1, kFieldLetters[field])};
  }
  std::sort(parts.begin(), parts.end());
  return join({parts[0].second, parts[1].second, parts[2].second, parts[3].second});
}

}  // namespace

Result<TableLayout> decide_layout(TableSample sample, const OpenOptions& options, const std::string& location,
                                  RecordingInfo& info) {
  TableLayout layout;
  E2LF_ASSIGN_OR_RETURN(const Columns columns, decide_columns(sample, options, info, location));
  layout.columns = columns.columns;
  E2LF_ASSIGN_OR_RETURN(const Unit unit, decide_unit(sample, layout.columns[of(Field::kT)], options, location));
  layout.unit = unit.unit;
  E2LF_ASSIGN_OR_RETURN(const Polarity polarity, decide_polarity(sample, layout.columns[of(Field::kP)], location));
  layout.polarity = polarity.code;
  warn_of_values(sample, layout, info, location);

  info.table =
      TableReading{columns_text(sample, layout.columns), time_unit_name(layout.unit), polarity_text(layout.polarity)};
  const bool is_certain =
      columns.reason != Reason::kValues && unit.reason != Reason::kValues && polarity.warning.empty();
  if (is_certain || sample.columns[0].values.empty()) return layout;
  const std::string why = unit.reason == Reason::kValues ? unit.why : reason_text(unit.reason);
  info.assumptions.push_back(
      {cat("the columns were read as ", info.table->columns, " (", reason_text(columns.reason), "), the times as ",
           info.table->time_unit, " (", why, "), the polarities as ", info.table->polarity, polarity.warning),
       sample.is_ordered ? Setting::kColumns : Setting::kTimeUnit});
  return layout;
}

Result<void> refuse_table_options(const OpenOptions& options, const std::string& format, const std::string& location) {
  const bool has_unit = options.time_unit != TimeUnit::kAuto;
  if (!has_unit && options.columns.empty()) return {};
  return undecided(cat("the format ", format, " fixes ", has_unit ? "the unit of its times" : "what its numbers mean",
                       "; leave the option out"),
                   location, has_unit ? Setting::kTimeUnit : Setting::kColumns);
}

Result<void> require_mostly_events(uint64_t events, uint64_t bad, const RecordingInfo& info,
                                   const std::string& first_bad, const std::string& location) {
  if (bad <= events) return {};
  const std::string columns = info.table ? info.table->columns : "t, x, y, p";
  return Error{ErrorCode::kFormat,
               cat(bad, " of ", bad + events, " rows cannot be read as ", columns, " (the first ", first_bad,
                   "); give the order of the columns or correct the file"),
               location, Setting::kColumns};
}

}  // namespace e2lf::recordings::table
