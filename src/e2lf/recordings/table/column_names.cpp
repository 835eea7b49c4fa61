// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/column_names.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

namespace e2lf::recordings::table {
namespace {

/// Returns the words of a text in lower case. A capital after a small letter begins a word ("timestampNs"), the Greek
/// letter of "us" is replaced by a Latin one, and "micro seconds" becomes one word.
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
  for (size_t i = 0; i + 1 < words.size(); ++i) {
    const bool is_prefix = words[i] == "milli" || words[i] == "micro" || words[i] == "nano";
    if (!is_prefix || !words[i + 1].starts_with("sec")) continue;
    words[i] += words[i + 1];
    words.erase(words.begin() + static_cast<ptrdiff_t>(i) + 1);
  }
  return words;
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Returns the unit in the last of the words; "10^-6 s" and "1e-6 s" are microseconds. The words of a power are
/// removed, and the unit is unknown if there is another number.
TimeUnit take_unit_from(std::vector<std::string>& words) {
  const TimeUnit unit = parse_time_unit(words.back());
  const auto number = std::find_if(words.begin(), words.end(), [](const std::string& word) {
    return std::isdigit(static_cast<unsigned char>(word.front())) != 0;
  });
  if (number == words.end()) return unit;
  const bool is_power = (*number == "10" || *number == "1e") && words.end() - number == 3 && unit == TimeUnit::kSeconds;
  const std::string power = is_power ? *(number + 1) : "";
  words.erase(number, words.end());
  return power == "9"   ? TimeUnit::kNanoseconds
         : power == "6" ? TimeUnit::kMicroseconds
         : power == "3" ? TimeUnit::kMilliseconds
                        : TimeUnit::kAuto;
}

struct KnownName {
  Field field;
  std::string_view name;
  bool is_prefix = false;
};

constexpr KnownName kNames[] = {{Field::kT, "t"},
                                {Field::kT, "ts"},
                                {Field::kT, "timestamp", true},
                                {Field::kT, "time"},
                                {Field::kT, "times"},
                                {Field::kT, "zeit", true},
                                {Field::kT, "temps", true},
                                {Field::kT, "tiempo", true},
                                {Field::kT, "tempo", true},
                                {Field::kX, "x"},
                                {Field::kX, "xs"},
                                {Field::kX, "col"},
                                {Field::kX, "column"},
                                {Field::kY, "y"},
                                {Field::kY, "ys"},
                                {Field::kY, "row"},
                                {Field::kP, "p"},
                                {Field::kP, "ps"},
                                {Field::kP, "pol"},
                                {Field::kP, "pols"},
                                {Field::kP, "polari", true},
                                {Field::kP, "on"},
                                {Field::kP, "sign"}};

}  // namespace

TimeUnit parse_time_unit(std::string_view word) {
  if (is_one_of(word, {"s", "sec", "secs", "second", "seconds"})) return TimeUnit::kSeconds;
  if (is_one_of(word,
                {"ms", "msec", "msecs", "milli", "millis", "millisec", "millisecs", "millisecond", "milliseconds"}))
    return TimeUnit::kMilliseconds;
  if (is_one_of(word,
                {"us", "usec", "usecs", "micro", "micros", "microsec", "microsecs", "microsecond", "microseconds"}))
    return TimeUnit::kMicroseconds;
  if (is_one_of(word, {"ns", "nsec", "nsecs", "nano", "nanos", "nanosec", "nanosecs", "nanosecond", "nanoseconds"}))
    return TimeUnit::kNanoseconds;
  return TimeUnit::kAuto;
}

const char* time_unit_name(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return "s";
    case TimeUnit::kMilliseconds:
      return "ms";
    case TimeUnit::kNanoseconds:
      return "ns";
    case TimeUnit::kAuto:
    case TimeUnit::kMicroseconds:
      break;
  }
  return "us";
}

ColumnName parse_column_name(std::string_view name) {
  std::vector<std::string> words = words_of(name);
  const auto is_filler = [](const std::string& word) {
    return is_one_of(word, {"event",    "events",    "ev",       "px",     "pixel",      "pixels",      "pos",
                            "position", "positions", "coord",    "coords", "coordinate", "coordinates", "addr",
                            "address",  "loc",       "location", "in",     "data",       "dataset",     "dvs"});
  };
  words.erase(std::remove_if(words.begin(), words.end(), is_filler), words.end());
  if (words.size() > 1 && words[0] == "time" && words[1] == "stamp") {
    words.erase(words.begin());
    words[0] = "timestamp";
  }
  ColumnName result;
  // A name in another language may still say the unit.
  if (words.size() > 1) result.unit = take_unit_from(words);
  if (words.empty() || words.size() > 2) return result;
  if (words.size() == 1 && words[0] == "xy") result.is_xy = true;
  for (const KnownName& known : kNames) {
    const bool fits = known.is_prefix ? words[0].starts_with(known.name) : words[0] == known.name;
    if (!fits) continue;
    // Any other second word changes the meaning: "t_offset".
    if (words.size() == 2 && (known.field != Field::kT || result.unit == TimeUnit::kAuto)) return result;
    result.field = known.field;
    result.rank = static_cast<size_t>(&known - kNames);
    return result;
  }
  return result;
}

TimeUnit unit_in_sentence(std::string_view text) {
  if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; })) {
    return TimeUnit::kAuto;
  }
  const std::vector<std::string> words = words_of(text);
  const auto is_about_times = [](const std::string& word) {
    return is_one_of(word, {"t", "time", "times", "timestamp", "timestamps", "unit", "units"});
  };
  if (std::none_of(words.begin(), words.end(), is_about_times)) return TimeUnit::kAuto;
  for (size_t i = 1; i < words.size(); ++i) {
    const TimeUnit unit = parse_time_unit(words[i]);
    if (unit != TimeUnit::kAuto && (is_about_times(words[i - 1]) || is_one_of(words[i - 1], {"in", "are", "is"}))) {
      return unit;
    }
  }
  return TimeUnit::kAuto;
}

}  // namespace e2lf::recordings::table
