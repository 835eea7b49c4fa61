// SPDX-License-Identifier: MIT
#include "e2lf/formats/text/csv_layout.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::formats::text {
namespace {

bool is_utf16(std::span<const uint8_t> bytes) {
  return bytes.size() >= 2 && ((bytes[0] == 0xFF && bytes[1] == 0xFE) || (bytes[0] == 0xFE && bytes[1] == 0xFF));
}

/// A line and its words, which comments lack.
struct Line {
  std::string_view text;
  std::vector<std::string_view> words = {};
  std::vector<std::optional<double>> values = {};
  size_t numbers = 0;

  explicit Line(std::string_view marked) : text(without_mark(marked)) {
    if (is_comment(text)) return;
    words = split(text);
    for (const std::string_view word : words) {
      values.push_back(parse_cell(word));
      numbers += values.back().has_value();
    }
  }
  /// Returns true if there are enough numbers for an event; other columns may contain text.
  [[nodiscard]] bool are_numbers() const { return numbers >= table::kNumFields; }
};

std::vector<Line> lines_of(std::string_view text, bool is_whole) {
  std::vector<Line> lines;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    // The last line may be incomplete, unless it is the only one.
    if (end == std::string_view::npos && !is_whole && !lines.empty()) break;
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

/// Returns the number of columns of most lines.
size_t num_columns(const std::vector<Line>& lines) {
  std::map<size_t, size_t> counts;
  for (const Line& line : lines) {
    if (line.are_numbers()) ++counts[line.words.size()];
  }
  const auto is_rarer = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto most = std::max_element(counts.begin(), counts.end(), is_rarer);
  return most == counts.end() ? 0 : most->first;
}

/// Reads the width and the height of a sensor from two numbers.
void read_size(const std::vector<std::string_view>& words, TextHead& head) {
  size_t size[2] = {};
  for (size_t i = 0; i < 2; ++i) {
    const char* const end = words[i].data() + words[i].size();
    const auto [next, error] = std::from_chars(words[i].data(), end, size[i]);
    if (error != std::errc() || next != end || size[i] == 0 || size[i] > 65536) return;
  }
  head.width = size[0];
  head.height = size[1];
}

/// Reads "%geometry:640,480", below which OpenEB writes x, y, p, t.
void read_geometry(std::string_view line, TextHead& head) {
  constexpr std::string_view kGeometry = "%geometry:";
  if (!line.starts_with(kGeometry)) return;
  const std::vector<std::string_view> words = split(line.substr(kGeometry.size()));
  if (words.size() == 2) read_size(words, head);
  head.sample.order = "xypt";
}

/// Returns the names in a line, which are separated by commas, semicolons, bars or tabs, or else by blanks. A unit in
/// brackets belongs to the name before it.
std::vector<std::string> names_in(std::string_view line) {
  line.remove_prefix(std::min(line.size(), line.find_first_not_of("#%/; \t")));
  const auto has = [line](char c) { return line.find(c) != std::string_view::npos; };
  const char separator = has(',') ? ',' : has(';') ? ';' : has('|') ? '|' : has('\t') ? '\t' : ' ';
  std::vector<std::string> names;
  while (!line.empty()) {
    const std::string_view name = line.substr(0, line.find(separator));
    line.remove_prefix(std::min(line.size(), name.size() + 1));
    const size_t begin = name.find_first_not_of(" \r\"'");
    const bool is_empty = begin == std::string_view::npos;
    if (separator == ' ' && !is_empty && !names.empty() && (name[begin] == '[' || name[begin] == '(')) {
      names.back() += name;
    } else if (separator != ' ' || !is_empty) {
      names.emplace_back(name);
    }
  }
  return names;
}

/// Returns whether a line contains the names of an event's fields and nothing else.
bool are_known_names(const std::vector<std::string>& names) {
  const auto is_known = [](const std::string& name) { return table::parse_column_name(name).field.has_value(); };
  return table::are_complete(table::find_fields(names)) && std::all_of(names.begin(), names.end(), is_known);
}

/// Returns true if a word has six decimals, as times in seconds have that e2lf and E2VID write.
bool has_six_decimals(std::string_view word) {
  const size_t point = word.find('.');
  return point != std::string_view::npos && word.size() - point == 7 &&
         word.find_first_of("eE") == std::string_view::npos;
}

/// Reads the lines before the first event, and returns the number of these lines.
size_t read_header(const std::vector<Line>& lines, size_t columns, TextHead& head) {
  std::vector<std::string> names, names_in_comment;
  size_t i = 0;
  for (; i < lines.size(); ++i) {
    const Line& line = lines[i];
    if (is_comment(line.text)) {
      read_geometry(line.text, head);
      names_in_comment = names_in(line.text);
      if (!are_known_names(names_in_comment)) names_in_comment.clear();
    } else if (line.words.size() == 2 && line.numbers == 2) {
      read_size(line.words, head);
      head.header_line = line.text;
    } else if (!line.words.empty()) {
      const std::vector<std::string> words = names_in(line.text);
      const bool are_names = words.size() == columns && table::are_complete(table::find_fields(words));
      if (line.numbers > 0 && !are_names) break;
      names = words;
      head.header_line = line.text;
      if (columns > 0 || !head.first_bad.empty() || are_known_names(names)) continue;
      head.first_bad_number = i + 1;
      head.first_bad = quoted(line.text);
    }
  }
  if (names.empty()) names = names_in_comment;
  for (size_t column = 0; column < columns && names.size() == columns; ++column) {
    head.sample.columns[column].name = names[column];
  }
  return i;
}

void read_rows(const std::vector<Line>& lines, size_t begin, TextHead& head) {
  std::vector<table::TableSample::Column>& columns = head.sample.columns;
  for (table::TableSample::Column& column : columns) column.is_fraction = true;
  for (size_t i = begin; i < lines.size(); ++i) {
    const Line& line = lines[i];
    if (line.words.empty() || line.text == head.header_line) continue;
    ++head.lines;
    if (line.are_numbers() && line.words.size() == columns.size()) {
      for (size_t column = 0; column < columns.size(); ++column) {
        columns[column].values.push_back(line.values[column].value_or(0));
        columns[column].is_fraction &= has_six_decimals(line.words[column]);
      }
    } else if (head.bad_lines++ == 0) {
      head.first_bad_number = i + 1;
      head.first_bad = quoted(line.text);
    }
  }
  for (table::TableSample::Column& column : columns) column.is_fraction &= !column.values.empty();
}

}  // namespace

std::string quoted(std::string_view line) {
  constexpr size_t kMost = 60;
  return cat('"', printable(line.substr(0, kMost)), line.size() > kMost ? "...\"" : "\"");
}

Result<TextHead> read_head(std::span<const uint8_t> bytes, bool is_whole, const std::string& location) {
  if (is_utf16(bytes)) {
    return fail(ErrorCode::kUnsupported, location, "the text is encoded as UTF-16; save it as UTF-8 or ASCII");
  }
  const std::string_view text = as_text(bytes);
  const std::vector<Line> lines = lines_of(text, is_whole);
  TextHead head;
  head.sample.columns.resize(num_columns(lines));
  const size_t begin = read_header(lines, head.sample.columns.size(), head);
  const auto place_of = [&](const Line& line) { return static_cast<size_t>(line.text.data() - text.data()); };
  const auto end_of = [&](const Line& line) { return place_of(line) + line.text.size(); };
  head.header_bytes = begin < lines.size() ? place_of(lines[begin])
                      : lines.empty()      ? 0
                                           : std::min(text.size(), end_of(lines.back()) + 1);
  read_rows(lines, begin, head);
  return head;
}

namespace {

bool is_digit(char c) {
  return static_cast<unsigned char>(c - '0') < 10;
}

/// The number digits * 10^exponent, which represents up to 18 digits exactly.
struct Decimal {
  bool is_negative = false;
  uint64_t digits = 0;
  int exponent = 0;
};

/// Parses a number such as "+12", "-0.5" or "1.04e+03" at `next` and advances `next` past it.
bool parse_decimal(const char*& next, const char* end, Decimal& number) {
  constexpr uint64_t kFull = 100'000'000'000'000'000;  // one more digit fits
  number = {};
  if (next != end && (*next == '-' || *next == '+')) number.is_negative = *next++ == '-';
  const char* const begin = next;
  for (; next != end && is_digit(*next); ++next) {
    if (number.digits < 10 * kFull) {
      number.digits = number.digits * 10 + static_cast<uint64_t>(*next - '0');
    } else {
      ++number.exponent;
    }
  }
  size_t digits = static_cast<size_t>(next - begin);
  if (next != end && *next == '.') {
    const char* const fraction = ++next;
    for (; next != end && is_digit(*next); ++next) {
      if (number.digits >= kFull) continue;
      number.digits = number.digits * 10 + static_cast<uint64_t>(*next - '0');
      --number.exponent;
    }
    digits += static_cast<size_t>(next - fraction);
  }
  if (digits == 0) return false;
  if (next == end || (*next != 'e' && *next != 'E')) return true;
  ++next;
  const bool is_small = next != end && *next == '-';
  if (next != end && (*next == '-' || *next == '+')) ++next;
  if (next == end || !is_digit(*next)) return false;
  int exponent = 0;
  for (; next != end && is_digit(*next); ++next) exponent = std::min(exponent * 10 + (*next - '0'), 10000);
  number.exponent += is_small ? -exponent : exponent;
  return true;
}

enum class Rounding { kNone, kDown, kNearest };

/// Computes the number times 10^shift. Returns false if it is too large, or not an integer under kNone.
bool to_integer(const Decimal& number, int shift, Rounding rounding, int64_t& value) {
  constexpr uint64_t kMost = uint64_t{1} << 62;
  uint64_t result = number.digits;
  int exponent = number.exponent + shift;
  for (; exponent > 0 && result != 0; --exponent) {
    if (result > kMost / 10) return false;
    result *= 10;
  }
  uint64_t last = 0, rest = 0;  // the digits that are removed
  for (; exponent < 0 && (result != 0 || last != 0); ++exponent) {
    rest |= last;
    last = result % 10;
    result /= 10;
  }
  if (rounding == Rounding::kNone && (last | rest) != 0) return false;
  if (rounding == Rounding::kNearest) result += last >= 5;
  if (rounding == Rounding::kDown && number.is_negative) result += (last | rest) != 0;
  if (result > kMost) return false;
  value = number.is_negative ? -static_cast<int64_t>(result) : static_cast<int64_t>(result);
  return true;
}

double to_double(const Decimal& number) {
  // Dividing exact numbers rounds only once, so that "4.700000e+01" is an integer.
  const double power = std::pow(10.0, std::abs(number.exponent));
  const auto digits = static_cast<double>(number.digits);
  const double size = number.exponent < 0 ? digits / power : digits * power;
  return number.is_negative ? -size : size;
}

/// The powers of ten that convert to microseconds, by TimeUnit.
constexpr int kShifts[] = {0, 6, 3, 0, -3};

/// Parses "true" or "false", ignoring case.
std::optional<uint8_t> polarity_of(std::string_view word) {
  const auto is = [word](std::string_view name) {
    return std::equal(word.begin(), word.end(), name.begin(), name.end(),
                      [](char a, char b) { return (a | 0x20) == b; });
  };
  return is("true") ? std::optional<uint8_t>(1) : is("false") ? std::optional<uint8_t>(0) : std::nullopt;
}

bool is_letter(char c) {
  return static_cast<unsigned char>((c | 0x20) - 'a') < 26;
}

bool parse_polarity(const char*& next, const char* end, const table::PolarityCode& code, uint8_t& p) {
  if (next != end && is_letter(*next)) {
    const char* const begin = next;
    while (next != end && is_letter(*next)) ++next;
    const auto polarity = polarity_of({begin, static_cast<size_t>(next - begin)});
    if (polarity) p = *polarity;
    return polarity.has_value();
  }
  Decimal number;
  if (!parse_decimal(next, end, number)) return false;
  p = code.of(number.exponent == 0 && !number.is_negative ? static_cast<double>(number.digits) : to_double(number));
  return p != table::PolarityCode::kNone;
}

}  // namespace

bool is_separator(char c) {
  return c == ',' || c == ' ' || c == ';' || c == '\t' || c == '\r' || c == '\n' || c == '"' || c == '\'' || c == '|';
}

bool is_comment(std::string_view line) {
  line.remove_prefix(std::min(line.size(), line.find_first_not_of(" \t")));
  return !line.empty() && (line[0] == '#' || line[0] == '%' || line[0] == ';' || line.starts_with("//"));
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t i = 0; i < line.size();) {
    while (i < line.size() && is_separator(line[i])) ++i;
    const size_t begin = i;
    while (i < line.size() && !is_separator(line[i])) ++i;
    if (i > begin) words.push_back(line.substr(begin, i - begin));
  }
  return words;
}

std::optional<double> parse_cell(std::string_view word) {
  if (const auto polarity = polarity_of(word)) return *polarity;
  const char* next = word.data();
  Decimal number;
  if (!parse_decimal(next, word.data() + word.size(), number)) return std::nullopt;
  return next == word.data() + word.size() ? std::optional(to_double(number)) : std::nullopt;
}

bool parse_line(std::string_view line, const LineLayout& layout, Event& event) {
  const char* next = line.data();
  const char* const end = next + line.size();
  std::array<int64_t, table::kNumFields> values{};
  for (const auto& field : layout.columns) {
    while (next != end && is_separator(*next)) ++next;
    if (!field) {
      if (next == end) return false;
      while (next != end && !is_separator(*next)) ++next;
      continue;
    }
    int64_t& value = values[static_cast<size_t>(*field)];
    Decimal number;
    if (*field == table::Field::kP) {
      uint8_t polarity = 0;
      if (!parse_polarity(next, end, layout.polarity, polarity)) return false;
      value = polarity;
    } else if (!parse_decimal(next, end, number)) {
      return false;
    } else if (*field == table::Field::kT) {
      const bool is_ns = layout.unit == TimeUnit::kNanoseconds;
      if (!to_integer(number, kShifts[static_cast<size_t>(layout.unit)], is_ns ? Rounding::kDown : Rounding::kNearest,
                      value))
        return false;
    } else if (!to_integer(number, 0, Rounding::kNone, value)) {
      return false;
    }
    if (next != end && !is_separator(*next)) return false;
  }
  while (next != end && is_separator(*next)) ++next;
  const auto [x, y, p, t] = values;
  if ((next != end && *next != '#') || x < 0 || x > UINT16_MAX || y < 0 || y > UINT16_MAX) return false;
  event = {static_cast<uint16_t>(x), static_cast<uint16_t>(y), static_cast<uint8_t>(p), t};
  return true;
}

}  // namespace e2lf::formats::text
