// SPDX-License-Identifier: MIT
#include "e2lf/formats/table/column_names.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace e2lf::recordings::table {
namespace {

constexpr std::pair<std::string_view, Field> kNames[] = {
    {"t", Field::kT},         {"ts", Field::kT},         {"time", Field::kT},      {"times", Field::kT},
    {"timestamp", Field::kT}, {"timestamps", Field::kT}, {"x", Field::kX},         {"xs", Field::kX},
    {"col", Field::kX},       {"column", Field::kX},     {"y", Field::kY},         {"ys", Field::kY},
    {"row", Field::kY},       {"p", Field::kP},          {"ps", Field::kP},        {"pol", Field::kP},
    {"pols", Field::kP},      {"polarity", Field::kP},   {"polarities", Field::kP}};

/// Words that leave the meaning of a name unchanged: "event_x", "dataset_events_t", "x [px]", "time in us".
constexpr std::string_view kFillers[] = {"event", "events", "dataset", "px", "pixel", "pixels", "in"};

/// The name of a unit and its duration in microseconds, by TimeUnit.
constexpr std::pair<const char*, double> kUnits[] = {{"us", 1}, {"s", 1e6}, {"ms", 1e3}, {"us", 1}, {"ns", 1e-3}};

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

}  // namespace

ColumnName parse_column_name(std::string_view name) {
  std::vector<std::string> words = words_of(name);
  std::erase_if(words, [](const std::string& word) {
    return std::find(std::begin(kFillers), std::end(kFillers), word) != std::end(kFillers);
  });
  ColumnName result;
  if (words.size() > 1) result.unit = parse_time_unit(words.back());
  if (result.unit != TimeUnit::kAuto) words.pop_back();
  std::string joined;  // "time stamp"
  for (const std::string& word : words) joined += word;
  result.is_xy = joined == "xy";
  const auto known =
      std::find_if(std::begin(kNames), std::end(kNames), [&](const auto& k) { return k.first == joined; });
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
    columns[of(*field)] = i;
    ++counts[of(*field)];
  }
  for (size_t field = 0; field < kNumFields; ++field) {
    if (counts[field] > 1) columns[field].reset();
  }
  return columns;
}

bool are_complete(const KnownColumns& columns) {
  return std::all_of(columns.begin(), columns.end(), [](const auto& column) { return column.has_value(); });
}

TimeUnit parse_time_unit(std::string_view word) {
  if (word.size() > 2 && word.ends_with('s')) word.remove_suffix(1);  // "secs"
  const auto known =
      std::find_if(std::begin(kUnitWords), std::end(kUnitWords), [&](const auto& k) { return k.first == word; });
  return known == std::end(kUnitWords) ? TimeUnit::kAuto : known->second;
}

double us_per(TimeUnit unit) {
  return kUnits[static_cast<size_t>(unit)].second;
}

const char* time_unit_name(TimeUnit unit) {
  return kUnits[static_cast<size_t>(unit)].first;
}

}  // namespace e2lf::recordings::table
