// SPDX-License-Identifier: MIT
#include "e2lf/formats/table/table.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "e2lf/base/log.h"
#include "e2lf/base/median.h"
#include "e2lf/base/text.h"
#include "e2lf/files/npy.h"

namespace e2lf::formats::table {
namespace {

constexpr std::pair<std::string_view, Field> kNames[] = {
    {"t", Field::kT},         {"ts", Field::kT},         {"time", Field::kT},      {"times", Field::kT},
    {"timestamp", Field::kT}, {"timestamps", Field::kT}, {"x", Field::kX},         {"xs", Field::kX},
    {"col", Field::kX},       {"column", Field::kX},     {"y", Field::kY},         {"ys", Field::kY},
    {"row", Field::kY},       {"p", Field::kP},          {"ps", Field::kP},        {"pol", Field::kP},
    {"pols", Field::kP},      {"polarity", Field::kP},   {"polarities", Field::kP}};

/// Words that leave the meaning of a name unchanged: "event_x", "dataset_events_t", "x [px]", "time in us".
constexpr std::string_view kFillers[] = {"event", "events", "dataset", "px", "pixel", "pixels", "in"};

constexpr std::pair<std::string_view, TimeUnit> kUnitWords[] = {
    {"s", TimeUnit::kSeconds},       {"sec", TimeUnit::kSeconds},       {"second", TimeUnit::kSeconds},
    {"ms", TimeUnit::kMilliseconds}, {"msec", TimeUnit::kMilliseconds}, {"millisecond", TimeUnit::kMilliseconds},
    {"us", TimeUnit::kMicroseconds}, {"usec", TimeUnit::kMicroseconds}, {"microsecond", TimeUnit::kMicroseconds},
    {"ns", TimeUnit::kNanoseconds},  {"nsec", TimeUnit::kNanoseconds},  {"nanosecond", TimeUnit::kNanoseconds},
};

/// Returns the words of a name in lower case. A capital after a small letter begins a word ("timestampNs"), and the
/// Greek letter of "us" is replaced by a Latin one.
std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words(1);
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::string_view pair = text.substr(i, 2);
    const bool is_hump = i > 0 && std::isupper(byte) != 0 && std::islower(static_cast<unsigned char>(text[i - 1])) != 0;
    if (is_hump && !words.back().empty()) words.emplace_back();
    if (pair == "\xC2\xB5" || pair == "\xCE\xBC") {
      words.back() += 'u';
      ++i;
    } else if (byte >= 0x80 || std::isalnum(byte) != 0) {
      words.back() += static_cast<char>(byte < 0x80 ? std::tolower(byte) : byte);
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

constexpr double kMostDamaged = 0.1;    // share of the values of a column
constexpr double kWidestSensor = 8192;  // px; no sensor is wider

Error undecided(std::string message, const std::string& location, const char* option) {
  return {ErrorCode::kInvalidValue, std::move(message), location, option};
}

template <typename Test>
double share_of(const std::vector<double>& values, const Test& test) {
  if (values.empty()) return 0;
  return static_cast<double>(std::count_if(values.begin(), values.end(), test)) / static_cast<double>(values.size());
}

bool are_fractions(const TableSample::Column& column) {
  const auto is_fraction = [](double value) { return value != std::trunc(value); };
  return column.is_fraction || share_of(column.values, is_fraction) >= kMostDamaged;
}

/// Returns the columns of an order such as "txyp" or "t-xyp", or nothing if it is not one of `count` columns.
std::optional<ColumnsOfFields> columns_of_order(const std::string& order, size_t count) {
  ColumnsOfFields columns = {};
  bool fits = order.size() == count && order.find_first_not_of("xypt-") == std::string::npos;
  for (size_t field = 0; field < kNumFields; ++field) {
    columns[field] = order.find(kFieldLetters[field]);
    fits = fits && columns[field] != std::string::npos && columns[field] == order.rfind(kFieldLetters[field]);
  }
  return fits ? std::optional(columns) : std::nullopt;
}

Result<ColumnsOfFields> columns_of_option(const std::string& order, const TableSample& sample,
                                          const std::string& location) {
  if (!sample.is_ordered) {
    return undecided("the columns are identified by names, so they have no order; leave the option out", location,
                     "columns");
  }
  if (const auto columns = columns_of_order(order, sample.columns.size())) return *columns;
  return undecided(cat("\"", order, "\" is not an order of the ", sample.columns.size(),
                       " columns; write each of t, x, y, p once, e.g. txyp, and - for a column to skip"),
                   location, "columns");
}

/// Joins the first texts of a list for messages.
std::string few(std::vector<std::string> texts, size_t most) {
  const bool has_more = texts.size() > most;
  texts.resize(std::min(most, texts.size()));
  return join(texts) + (has_more ? ", ..." : "");
}

std::string names_text(const std::vector<std::string>& names) {
  std::vector<std::string> texts;
  for (const std::string& name : names) texts.push_back(printable(name));
  return few(std::move(texts), 10);
}

std::string values_text(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : std::set<double>(values.begin(), values.end())) texts.push_back(cat(value));
  return few(std::move(texts), 4);
}

Result<ColumnsOfFields> columns_of(const TableSample& sample, const OpenOptions& options, const std::string& location) {
  if (!options.columns.empty()) return columns_of_option(options.columns, sample, location);
  std::vector<std::string> names;
  for (const TableSample::Column& column : sample.columns) names.push_back(column.name);
  const size_t count = names.size();
  if (const KnownColumns named = find_fields(names); are_complete(named)) {
    return ColumnsOfFields{*named[0], *named[1], *named[2], *named[3]};
  }
  if (std::any_of(names.begin(), names.end(), [](const std::string& name) { return !name.empty(); })) {
    return undecided(
        cat("the names of the columns (", names_text(names), ") do not state once each which are t, x, y ",
            "and p; state their order, e.g. ", std::string("txyp-----").substr(0, std::max(count, kNumFields)),
            ", or check whether these are events"),
        location, "columns");
  }
  const bool is_empty = count == kNumFields && sample.columns[0].values.empty();
  const bool begins_with_seconds = count == kNumFields && are_fractions(sample.columns[0]);
  const std::string order = !sample.order.empty() ? sample.order : is_empty || begins_with_seconds ? "txyp" : "";
  if (const auto columns = columns_of_order(order, count)) return *columns;
  return undecided(
      cat("the ", count, " columns have no names; state their order, txyp or xypt for example, and the unit ",
          "of the times, or check whether these are events"),
      location, "columns");
}

/// Returns the distance of the numbers in which the largest of the times are stored.
double step_of(const TableSample::Column& times) {
  const double last = *std::max_element(times.values.begin(), times.values.end());
  return std::ldexp(1.0, std::ilogb(std::max(last, 1e-9)) - times.mantissa_bits);
}

Result<TimeUnit> unit_of(const TableSample::Column& times, const TableSample& sample, const OpenOptions& options,
                         const std::string& location) {
  constexpr double kLatestUs = 1e17;      // 3,000 years
  constexpr double kRarestEvents_hz = 1;  // more likely ms or us with fractions
  const auto refuse = [&](const char* why) {
    return undecided(cat("the times ", why, "; state their unit"), location, "time_unit");
  };
  if (options.time_unit != TimeUnit::kAuto) return options.time_unit;
  const ColumnName name = parse_column_name(times.name);
  if (!name.field && times.name.find_first_of("0123456789") != std::string::npos) {  // "t (100 ns)"
    return refuse("count something else than s, ms, us or ns");
  }
  for (const TimeUnit unit : {times.unit, name.unit, sample.unit}) {
    if (unit != TimeUnit::kAuto) return unit;
  }
  const std::vector<double>& values = times.values;
  if (values.empty()) return TimeUnit::kMicroseconds;
  if (!are_fractions(times)) {
    if (times.mantissa_bits > 0 && step_of(times) > 1)
      return refuse("have too few digits to distinguish microseconds from seconds");
    if (median(values) >= kLatestUs) return refuse("are too large to be microseconds");
    return TimeUnit::kMicroseconds;
  }
  const double span_s = std::fabs(values.back() - values.front());
  if (kRarestEvents_hz * span_s <= static_cast<double>(values.size())) return TimeUnit::kSeconds;
  return refuse("have fractions, but are too far apart to be seconds");
}

Result<PolarityCode> polarity_of(const std::vector<double>& values, const OpenOptions& options,
                                 const std::string& location) {
  PolarityCode code;
  const auto has = [&](double value) { return std::find(values.begin(), values.end(), value) != values.end(); };
  if (!options.polarities.empty()) {
    int length = 0;
    const int found = std::sscanf(options.polarities.c_str(), "%lf,%lf%n", &code.off, &code.on, &length);
    if (found != 2 || static_cast<size_t>(length) != options.polarities.size() || code.off == code.on) {
      return undecided(cat("\"", options.polarities,
                           "\" is not a pair of polarities; write the number of OFF and that of ON, e.g. 1,2"),
                       location, "");
    }
    code.off_too = code.off;
  } else if (has(-1) != has(0)) {
    code.off = code.off_too = has(-1) ? -1 : 0;
  }
  const bool is_ambiguous = options.polarities.empty() && has(-1) && has(0);
  const auto is_other = [&](double value) { return code.of(value) == PolarityCode::kNone; };
  if (!is_ambiguous && share_of(values, is_other) <= kMostDamaged) return code;
  return undecided(cat("the polarities are ", values_text(values),
                       " and neither 0 and 1 nor -1 and 1; state the numbers of OFF and ON as ",
                       "the setting polarities, e.g. 1,2, or check which column contains them"),
                   location, "");
}

/// Refuses coordinates that are not those of pixels.
Result<void> check_coordinates(const TableSample& sample, const ColumnsOfFields& columns, const RecordingInfo& info,
                               const std::string& location) {
  for (const Field field : {Field::kX, Field::kY}) {
    const TableSample::Column& column = sample.columns[columns[of(field)]];
    if (are_fractions(column)) {
      return fail(ErrorCode::kUnsupported, location, "the coordinates ", kFieldLetters[of(field)],
                  " are fractions of pixels, e.g. ", values_text(column.values),
                  "; round them to the pixels of the sensor");
    }
    const auto is_beyond = [](double value) { return value >= kWidestSensor; };
    if (info.width == 0 && share_of(column.values, is_beyond) > kMostDamaged) {
      return undecided(
          cat("the coordinates ", kFieldLetters[of(field)], " reach ",
              *std::max_element(column.values.begin(), column.values.end()),
              " px, more than any sensor has; divide them if they are fractions of pixels (BS-ERGB stores ",
              "1/32 px), or state the size of the sensor"),
          location, "sensor_width");
    }
  }
  return {};
}

/// Refuses or doubts times that are stored too coarsely.
Result<void> check_resolution(const TableSample::Column& times, TimeUnit unit, const std::string& location) {
  constexpr double kCoarseUs = 10, kTooCoarseUs = 1000;
  if (times.mantissa_bits == 0 || times.values.empty()) return {};
  const double step_us = step_of(times) * us_per(unit);
  if (step_us <= kCoarseUs) return {};
  const std::string text = cat("the times are floating-point numbers that are ", step_us,
                               " us apart; store them as integers or with 64 bits");
  if (step_us > kTooCoarseUs) return fail(ErrorCode::kInvalidValue, location, text);
  log_warning(cat(location, ": ", text));
  return {};
}

std::string columns_text(const TableSample& sample, const ColumnsOfFields& columns) {
  std::array<std::pair<size_t, std::string>, kNumFields> parts;
  for (size_t field = 0; field < kNumFields; ++field) {
    parts[field] = {sample.is_ordered ? columns[field] : field, std::string(1, kFieldLetters[field])};
  }
  std::sort(parts.begin(), parts.end());
  return join({parts[0].second, parts[1].second, parts[2].second, parts[3].second});
}

/// Calls visit(i, number) for the first `count` numbers of a column.
template <typename Visit>
void for_each_number(const NumberColumn& column, size_t count, const Visit& visit) {
  if (count == 0) return;  // there may be no records to point to
  const NumberField& field = column.field;
  const bool known = with_element_type(field.type, [&](auto type) {
    const uint8_t* next = column.records + field.offset;
    for (size_t i = 0; i < count; ++i, next += field.stride) visit(i, load_element<decltype(type)>(next));
  });
  E2LF_REQUIRE(known, "not a type of numbers: " + field.type);
}

/// Removes the events whose bad[i] is set, and returns their number.
size_t remove_bad(EventColumns& events, const Column<uint8_t>& bad) {
  if (std::ranges::none_of(bad, [](uint8_t b) { return b != 0; })) return 0;
  size_t kept = 0;
  for (size_t i = 0; i < events.size(); ++i) {
    if (bad[i] == 0) events.set(kept++, events[i]);
  }
  const size_t removed = events.size() - kept;
  events.resize(kept);
  return removed;
}

}  // namespace

ColumnName parse_column_name(std::string_view name) {
  std::vector<std::string> words = words_of(name);
  std::erase_if(words, [](const std::string& word) { return std::ranges::count(kFillers, word) > 0; });
  ColumnName result;
  if (words.size() > 1) result.unit = parse_time_unit(words.back());
  if (result.unit != TimeUnit::kAuto) words.pop_back();
  const std::string joined = join(words, "");  // "time stamp"
  result.is_xy = joined == "xy";
  const auto* const known = std::ranges::find(kNames, joined, &std::pair<std::string_view, Field>::first);
  if (known == std::end(kNames)) return result;
  if (known->second == Field::kT || result.unit == TimeUnit::kAuto) result.field = known->second;
  return result;
}

KnownColumns find_fields(std::span<const std::string> names) {
  KnownColumns columns;
  std::array<size_t, kNumFields> counts{};
  for (size_t i = 0; i < names.size(); ++i) {
    const auto field = parse_column_name(names[i]).field;
    if (!field) continue;
    const bool is_first = counts[of(*field)]++ == 0;
    columns[of(*field)] = is_first ? std::optional(i) : std::nullopt;
  }
  return columns;
}

bool are_complete(const KnownColumns& columns) {
  return std::ranges::all_of(columns, [](const auto& column) { return column.has_value(); });
}

TimeUnit parse_time_unit(std::string_view word) {
  if (word.size() > 2 && word.ends_with('s')) word.remove_suffix(1);  // "secs"
  const auto* const known = std::ranges::find(kUnitWords, word, &std::pair<std::string_view, TimeUnit>::first);
  return known == std::end(kUnitWords) ? TimeUnit::kAuto : known->second;
}

double us_per(TimeUnit unit) {
  constexpr double kDurationsUs[] = {1, 1e6, 1e3, 1, 1e-3};
  return kDurationsUs[static_cast<size_t>(unit)];
}

Result<TableLayout> decide_layout(const TableSample& sample, const OpenOptions& options, const std::string& location,
                                  RecordingInfo& info) {
  TableLayout layout;
  E2LF_ASSIGN_OR_RETURN(layout.columns, columns_of(sample, options, location));
  const TableSample::Column& times = sample.columns[layout.columns[of(Field::kT)]];
  E2LF_ASSIGN_OR_RETURN(layout.unit, unit_of(times, sample, options, location));
  const std::vector<double>& polarities = sample.columns[layout.columns[of(Field::kP)]].values;
  E2LF_ASSIGN_OR_RETURN(layout.polarity, polarity_of(polarities, options, location));
  E2LF_RETURN_IF_ERROR(check_coordinates(sample, layout.columns, info, location));
  E2LF_RETURN_IF_ERROR(check_resolution(times, layout.unit, location));
  info.table = TableReading{columns_text(sample, layout.columns), word_of(layout.unit, kTimeUnits),
                            cat(layout.polarity.off, " = OFF, ", layout.polarity.on, " = ON")};
  return layout;
}

Result<void> require_mostly_events(uint64_t events, uint64_t bad, const RecordingInfo& info,
                                   const std::string& first_bad, const std::string& location) {
  if (bad <= events) return {};
  const std::string columns = info.table ? info.table->columns : "t, x, y, p";
  return Error{ErrorCode::kFormat,
               cat(bad, " of ", bad + events, " rows cannot be read as ", columns, first_bad,
                   "; state the order of the columns or correct the file"),
               location, "columns"};
}

bool is_number_type(const std::string& type) {
  return element_size(type) > 0;
}

template <typename T>
void to_column(const NumberColumn& column, size_t count, T* out, uint8_t* bad) {
  for_each_number(column, count, [&](size_t i, auto number) { bad[i] |= convert_one(number, out[i]); });
}

template void to_column(const NumberColumn&, size_t, uint8_t*, uint8_t*);
template void to_column(const NumberColumn&, size_t, uint16_t*, uint8_t*);

void to_times(const NumberColumn& column, TimeUnit unit, size_t count, int64_t* out, uint8_t* bad) {
  for_each_number(column, count, [&](size_t i, auto number) { bad[i] |= convert_time(number, unit, out[i]); });
}

size_t to_events(std::span<const NumberColumn> columns, const TableLayout& layout, size_t count, EventColumns& events) {
  const auto [x, y, p, t] = layout.columns;
  events.resize(count);
  Column<uint8_t> bad(count, 0);
  to_column(columns[x], count, events.x.data(), bad.data());
  to_column(columns[y], count, events.y.data(), bad.data());
  for_each_number(columns[p], count, [&](size_t i, auto number) {
    events.p[i] = layout.polarity.of(static_cast<double>(number));
    bad[i] |= events.p[i] == PolarityCode::kNone;
  });
  to_times(columns[t], layout.unit, count, events.t.data(), bad.data());
  return remove_bad(events, bad);
}

std::vector<double> to_doubles(const NumberColumn& column, size_t count) {
  std::vector<double> values(count);
  for_each_number(column, count, [&](size_t i, auto number) { values[i] = static_cast<double>(number); });
  return values;
}

TableSample::Column sample_of(std::string name, const NumberColumn& column, size_t count) {
  TableSample::Column sample{.name = std::move(name), .values = to_doubles(column, count)};
  sample.mantissa_bits = column.field.type == "f2" ? 10 : column.field.type == "f4" ? 23 : 0;
  return sample;
}

bool read_sensor_size(const std::function<std::vector<double>(const char* name)>& numbers, RecordingInfo& info) {
  constexpr double kWidestPx = 65536;
  std::vector<double> size = numbers("size");
  if (size.size() != 2) {
    size = numbers("sensor_resolution");
    std::reverse(size.begin(), size.end());
  }
  if (size.size() != 2) {
    size = numbers("width");
    for (const double height : numbers("height")) size.push_back(height);
  }
  const auto is_side = [](double side) { return side >= 1 && side <= kWidestPx && side == std::trunc(side); };
  if (size.size() != 2 || !is_side(size[0]) || !is_side(size[1])) return false;
  info.width = static_cast<size_t>(size[0]);
  info.height = static_cast<size_t>(size[1]);
  return true;
}

}  // namespace e2lf::formats::table
