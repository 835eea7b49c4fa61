// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/time_units.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

namespace e2lf::recordings::table {
namespace {

/// The name of a unit and its duration in microseconds, by TimeUnit.
struct KnownUnit {
  const char* name;
  double us;
};
constexpr KnownUnit kUnits[] = {{"us", 1}, {"s", 1e6}, {"ms", 1e3}, {"us", 1}, {"ns", 1e-3}};

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

bool is_letter(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x80 || std::isalpha(byte) != 0;
}

/// Parses a number at the start of a text, "1e-6" or "10^-6", and removes it.
double take_number(std::string_view& text) {
  double number = 0;
  const auto take = [&](auto& value) {
    text.remove_prefix(
        static_cast<size_t>(std::from_chars(text.data(), text.data() + text.size(), value).ptr - text.data()));
  };
  take(number);
  if (number != 10 || !text.starts_with("^-")) return number;
  int power = 0;
  text.remove_prefix(1);
  take(power);
  return std::pow(10.0, power);
}

/// Returns a unit of durations in seconds, also one in which times are not read, or the period of a unit of
/// frequencies; 0 for other words.
double seconds_of(std::string_view word) {
  if (const TimeUnit unit = parse_time_unit(word); unit != TimeUnit::kAuto) return us_per(unit) * 1e-6;
  if (is_one_of(word, {"ps", "picosecond", "picoseconds"})) return 1e-12;
  if (is_one_of(word, {"min", "mins", "minute", "minutes"})) return 60;
  if (is_one_of(word, {"h", "hr", "hrs", "hour", "hours"})) return 3600;
  if (is_one_of(word, {"day", "days"})) return 86400;
  return word == "hz" ? 1 : word == "khz" ? 1e-3 : word == "mhz" ? 1e-6 : word == "ghz" ? 1e-9 : 0;
}

}  // namespace

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

TimeUnit parse_time_unit(std::string_view word) {
  const auto begins = [word](std::initializer_list<std::string_view> words) {
    return std::any_of(words.begin(), words.end(), [word](std::string_view begin) { return word.starts_with(begin); });
  };
  if (is_one_of(word, {"s", "sec", "secs", "秒"}) || begins({"second", "sekund", "segundo"})) return TimeUnit::kSeconds;
  if (is_one_of(word, {"ms", "msec", "msecs", "milli", "毫秒"}) || begins({"millis", "milisegundo"})) {
    return TimeUnit::kMilliseconds;
  }
  if (is_one_of(word, {"us", "usec", "usecs", "micro", "微秒"}) || begins({"micros", "mikros"})) {
    return TimeUnit::kMicroseconds;
  }
  if (is_one_of(word, {"ns", "nsec", "nsecs", "nano", "纳秒"}) || begins({"nanos"})) return TimeUnit::kNanoseconds;
  return TimeUnit::kAuto;
}

double us_per(TimeUnit unit) {
  return kUnits[static_cast<size_t>(unit)].us;
}

const char* time_unit_name(TimeUnit unit) {
  return kUnits[static_cast<size_t>(unit)].name;
}

TimeUnit unit_of_tick(double tick_s) {
  for (const TimeUnit unit :
       {TimeUnit::kSeconds, TimeUnit::kMilliseconds, TimeUnit::kMicroseconds, TimeUnit::kNanoseconds}) {
    if (std::fabs(tick_s * 1e6 / us_per(unit) - 1) < 1e-9) return unit;
  }
  return TimeUnit::kAuto;
}

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

std::vector<Token> tokens_of(std::string_view text) {
  std::vector<Token> tokens;
  while (!text.empty()) {
    const bool has_sign = (text[0] == '-' || text[0] == '+') && text.size() > 1 && is_digit(text[1]);
    // A hyphen after a word is no sign: "timestamp-1".
    if (is_digit(text[0]) || (has_sign && (tokens.empty() || is_one_of(tokens.back().word, {"=", ":", "/"})))) {
      const double sign = text[0] == '-' ? -1 : 1;
      if (has_sign) text.remove_prefix(1);
      tokens.push_back({"", sign * take_number(text)});
    } else if (is_letter(text[0])) {
      size_t end = 0;
      while (end < text.size() && (is_letter(text[end]) || is_digit(text[end]))) ++end;
      const std::string_view word = text.substr(0, end);
      text.remove_prefix(end);
      std::string_view factor = word.substr(1);
      if (word[0] == 'x' && !factor.empty() && std::all_of(factor.begin(), factor.end(), is_digit)) {
        tokens.push_back({"", take_number(factor)});  // "x1000 ns"
        continue;
      }
      for (std::string& part : words_of(word)) tokens.push_back({std::move(part), {}});
    } else {
      if (text[0] == '=' || text[0] == ':' || text[0] == '/') tokens.push_back({std::string(1, text[0]), {}});
      text.remove_prefix(1);
    }
  }
  return tokens;
}

double duration_at(const std::vector<Token>& tokens, size_t i) {
  constexpr double kLongestTick = 1e-3;  // a longer one needs a unit
  if (i >= tokens.size()) return 0;
  double number = tokens[i].number.value_or(1);
  size_t place = tokens[i].number ? i + 1 : i;
  if (tokens[i].number && place + 1 < tokens.size() && tokens[place].word == "/" && tokens[place + 1].number) {
    number /= *tokens[place + 1].number;
    place += 2;
  }
  if (!(number > 0)) return 0;
  if (place == tokens.size()) return number <= kLongestTick ? number : 0;
  const std::string& word = tokens[place].word;
  return word.ends_with("hz") ? seconds_of(word) / number : seconds_of(word) * number;
}

}  // namespace e2lf::recordings::table
