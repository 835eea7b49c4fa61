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
  constexpr const char* kTexts[] = {"as the option says", "as the file says", "as usual in this format",
                                    "by their values"};
  return kTexts[static_cast<size_t>(reason)];
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
  std::vector<std::string> names;
  for (const TableSample::Column& column : sample.columns) names.push_back(column.name);
  const KnownColumns named = find_fields(names);
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

/// Returns the first value of a column after the sample for which is_wanted() is true.
template <typename IsWanted>
Result<std::optional<double>> find_further(const TableSample& sample, size_t column, const IsWanted& is_wanted) {
  for (bool is_first = true;; is_first = false) {
    E2LF_ASSIGN_OR_RETURN(const std::vector<double> values, sample.more_values(column, is_first));
    if (values.empty()) return std::optional<double>();
    const auto wanted = std::find_if(values.begin(), values.end(), is_wanted);
    if (wanted != values.end()) return std::optional<double>(*wanted);
  }
}

/// If the times of the sample have a single value, which is not conclusive, adds a later one.
Result<void> complete_times(TableSample& sample, size_t column) {
  TableSample::Column& times = sample.columns[column];
  const auto is_zero = [](double time) { return time == 0; };
  if (times.is_integer || !sample.more_values || !std::all_of(times.values.begin(), times.values.end(), is_zero)) {
    return {};
  }
  E2LF_ASSIGN_OR_RETURN(const auto other, find_further(sample, column, [](double time) { return time != 0; }));
  if (other) times.values.assign(1, *other);
  return {};
}

struct Unit {
  TimeUnit unit = TimeUnit::kMicroseconds;
  Reason reason = Reason::kFile;
  const char* why = "";
};

Error odd_unit(double tick_s, const std::string& location) {
  return undecided(cat("the file states that its times count ", tick_s * 1e6,
                       " us, which is not a unit that is read; convert them, or give their unit"),
                   location, Setting::kTimeUnit);
}

Result<Unit> decide_unit(TableSample& sample, size_t column, const OpenOptions& options, const std::string& location) {
  constexpr double kLatestUs = 1e17;  // 3,000 years: larger ones are nanoseconds since 1970
  if (options.time_unit != TimeUnit::kAuto) return Unit{options.time_unit, Reason::kOption};
  TableSample::Column& times = sample.columns[column];
  if (times.unit != TimeUnit::kAuto) return Unit{times.unit};
  const ColumnName name = parse_column_name(times.name);
  if (name.unit != TimeUnit::kAuto) return Unit{name.unit};
  if (name.tick_s > 0) return odd_unit(name.tick_s, location);
  E2LF_RETURN_IF_ERROR(complete_times(sample, column));
  size_t set = 0, fractions = 0, large = 0;
  for (const double time : times.values) {
    set += time != 0;
    fractions += time != std::trunc(time);
    large += std::fabs(time) >= kLatestUs;
  }
  // A few values may be damaged.
  const bool are_fractions = fractions > 0 && 10 * fractions >= set;
  if (sample.tick_s > 0 && !are_fractions) {
    if (const TimeUnit unit = unit_of_tick(sample.tick_s); unit != TimeUnit::kAuto) return Unit{unit};
    return odd_unit(sample.tick_s, location);
  }
  if (sample.usual_unit != TimeUnit::kAuto) return Unit{sample.usual_unit, Reason::kFormat};
  if (are_fractions) {
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
  if (guess.has_off != guess.has_on && sample.more_values) {
    const double known = guess.has_on ? guess.code.on : guess.code.off;
    const auto is_other = [known](double value) { return value != known && is_polarity(value); };
    E2LF_ASSIGN_OR_RETURN(const auto other, find_further(sample, column, is_other));
    // As often as the other one, so that neither is an exception.
    if (other) values.insert(values.end(), values.size(), *other);
    guess = guess_polarity(values);
  }
  Polarity polarity{guess.code, ""};
  if (guess.has_on && !guess.has_off) polarity.warning = ", and there is no other polarity";
  PolarityCode& code = polarity.code;
  const auto has = [&](double value) { return std::find(values.begin(), values.end(), value) != values.end(); };
  if (code.on == 1 && has(0) && has(-1)) {
    if (!has(1)) {
      return undecided("the polarities are 0 and -1, of which none is known to be ON; write them as 0/1 or -1/1",
                       location, Setting::kColumns);
    }
    log_warning(cat(location, ": the polarities are 0, -1 and 1; both 0 and -1 are read as OFF"));
  }
  const PolarityStatement& stated = sample.polarities;
  if (stated.off == code.on || (stated.on && (*stated.on == code.off || *stated.on == code.off_too))) {
    code = {code.on, code.on, stated.on.value_or(code.off)};
  } else if (code.on == 2 && stated.on != 2 && stated.off != 1) {
    // As the MATLAB functions for N-MNIST number them.
    log_warning(
        cat(location, ": the polarities 1 and 2 are read as 1 = OFF, 2 = ON; --invert-polarity exchanges them"));
  }
  return polarity;
}

/// Warns if times are implausible in the unit in which they are read: if events would be too rare or too frequent, or,
/// if the unit was assumed, if all times were whole milliseconds or times since 1970 in another unit.
void warn_of_unit(const std::vector<double>& times, const Unit& read, const std::string& location) {
  constexpr size_t kFewEvents = 100;
  constexpr double kRarest_hz = 300, kRarestStated_hz = 1, kMostFrequent_hz = 2e7;
  constexpr double kYear2001Ms = 1e12, kYear2100Ms = 4.1e12;  // since 1970
  const TimeUnit unit = read.unit;
  const bool is_assumed = read.reason == Reason::kValues;
  if (times.size() < kFewEvents || read.reason == Reason::kOption) return;
  std::vector<double> sorted(times);
  std::sort(sorted.begin(), sorted.end());
  const size_t damaged = sorted.size() / 20;  // at either end
  const double middle = sorted[sorted.size() / 2];
  const double span_s = (sorted[sorted.size() - 1 - damaged] - sorted[damaged]) * us_per(unit) * 1e-6;
  if (!(span_s > 0)) return;
  const double rate_hz = static_cast<double>(sorted.size() - 2 * damaged) / span_s;
  const auto is_multiple = [unit](double time) {
    const double ms = time * us_per(unit) * 1e-3;
    return std::fabs(ms - std::round(ms)) < 1e-6;
  };
  const char* const smaller = unit == TimeUnit::kSeconds ? "ms" : unit == TimeUnit::kMilliseconds ? "us" : "ns";
  const char* const larger = unit == TimeUnit::kNanoseconds ? "us" : unit == TimeUnit::kMicroseconds ? "ms" : "s";
  const std::string words = cat(location, ": the times are read as ", time_unit_name(unit), " (",
                                is_assumed ? read.why : reason_text(read.reason), ")");
  const auto advise = [&](const std::string& why, const char* other) {
    log_warning(cat(words, ", ", why, "; if they are ", other, ", give their unit (--time-unit)"));
  };
  if (rate_hz < (is_assumed ? kRarest_hz : kRarestStated_hz)) {
    advise(cat("which makes only ", rate_hz, " events per second"), smaller);
  } else if (rate_hz > kMostFrequent_hz) {
    advise(cat("which makes ", rate_hz, " events per second"), larger);
  } else if (is_assumed && unit == TimeUnit::kMicroseconds && middle >= kYear2001Ms && middle < kYear2100Ms) {
    advise("which are also milliseconds since 1970", "ms");
  } else if (is_assumed && unit == TimeUnit::kNanoseconds && middle < kYear2001Ms * 1e6) {
    advise("which are not times since 1970", "us");
  } else if (is_assumed && std::all_of(times.begin(), times.end(), is_multiple)) {
    advise("and all of them are whole milliseconds", smaller);
  }
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
  const double last = most_of(times);
  const double step = times.is_single ? std::ldexp(1.0, std::ilogb(std::max(last, 1e-9)) - 23) : times.step;
  const double step_us = step * us_per(layout.unit);
  if (step_us > kCoarseUs) {
    log_warning(cat(location, ": the times are ",
                    times.is_single ? "floating-point numbers of 32 bits, which are " : "", step_us, " us apart at ",
                    last, " ", time_unit_name(layout.unit), "; store them as integers or with more digits"));
  }
  const double most_px = std::max(most_of(sample.columns[layout.columns[of(Field::kX)]]),
                                  most_of(sample.columns[layout.columns[of(Field::kY)]]));
  if (info.width == 0 && most_px >= kWidestPx) {
    log_warning(cat(location, ": the coordinates reach ", most_px,
                    " px, more than any sensor has; if they are fractions of pixels (BS-ERGB stores 1/32 px), divide "
                    "them first"));
  }
}

/// Warns if columns have names, which are unknown, and were identified by their values. These do not tell x from y.
void warn_of_names(const TableSample& sample, const TableLayout& layout, const std::string& location) {
  std::vector<std::string> guessed;
  for (const Field field : {Field::kX, Field::kY, Field::kT}) {
    const std::string& name = sample.columns[layout.columns[of(field)]].name;
    if (name.empty() || parse_column_name(name).field) continue;
    guessed.push_back(cat(printable(name), " as ", kFieldLetters[of(field)]));
  }
  if (guessed.empty()) return;
  log_warning(cat(location, ": names of columns are unknown, which were read by their values and order: ",
                  join(guessed), "; check this, and give the order and the unit (--columns, --time-unit)"));
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
  const TableSample::Column& times = sample.columns[layout.columns[of(Field::kT)]];
  warn_of_unit(times.values, unit, location);
  if (columns.reason != Reason::kOption) warn_of_names(sample, layout, location);

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

void check_stated_size(const TableSample& sample, const TableLayout& layout, const std::string& location,
                       RecordingInfo& info) {
  constexpr double kMostOutside = 0.1;
  const std::vector<double>&x = sample.columns[layout.columns[of(Field::kX)]].values,
        &y = sample.columns[layout.columns[of(Field::kY)]].values;
  const auto is_stated = [&](size_t width, size_t height) {
    size_t outside = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      outside += x[i] >= static_cast<double>(width) || y[i] >= static_cast<double>(height);
    }
    return static_cast<double>(outside) <= kMostOutside * static_cast<double>(x.size());
  };
  if (info.width == 0 || is_stated(info.width, info.height)) return;
  const std::string stated =
      cat(location, ": the header states ", info.width, "x", info.height, " px, but many events lie outside; ");
  if (is_stated(info.height, info.width)) {
    std::swap(info.width, info.height);
    log_warning(cat(stated, "the sensor is taken to have ", info.width, "x", info.height, " px"));
    return;
  }
  info.width = info.height = 0;
  log_warning(
      cat(stated, "this is not taken as the size of the sensor; give it with --sensor-width and --sensor-height"));
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
