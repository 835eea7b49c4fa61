// SPDX-License-Identifier: MIT
#include "e2lf/formats/text/csv_layout.h"

#include <algorithm>
#include <cctype>
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

/// Returns true for characters between two numbers: commas, semicolons, bars, blanks and quotes.
bool is_separator(char c) {
  return c == ',' || c == ' ' || c == ';' || c == '\t' || c == '\r' || c == '\n' || c == '"' || c == '\'' || c == '|';
}

/// Returns the words between separators.
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

/// Parses a number such as "+12", "-0.5" or "1.04e+03" at the front of `text`: as an integer if it is one, so that all
/// digits of a time in nanoseconds count. Returns its end, or null.
template <typename Visit>
const char* parse_number(const char* begin, const char* end, const Visit& visit) {
  if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
  int64_t whole = 0;
  double number = 0;
  const auto as_whole = std::from_chars(begin, end, whole);
  const bool goes_on = as_whole.ptr != end && (*as_whole.ptr == '.' || (*as_whole.ptr | 0x20) == 'e');
  if (as_whole.ec == std::errc() && !goes_on) return visit(whole) ? as_whole.ptr : nullptr;
  const auto as_number = std::from_chars(begin, end, number);
  return as_number.ec == std::errc() && std::isfinite(number) && visit(number) ? as_number.ptr : nullptr;
}

/// Parses "true" or "false", ignoring case.
std::optional<uint8_t> polarity_of(std::string_view word) {
  const auto is = [word](std::string_view name) {
    return std::equal(word.begin(), word.end(), name.begin(), name.end(),
                      [](char a, char b) { return (a | 0x20) == b; });
  };
  return is("true") ? std::optional<uint8_t>(1) : is("false") ? std::optional<uint8_t>(0) : std::nullopt;
}

/// Parses a number, or true or false. Returns nothing for other words.
std::optional<double> parse_cell(std::string_view word) {
  if (const auto polarity = polarity_of(word)) return *polarity;
  double value = 0;
  const char* const end = word.data() + word.size();
  const auto take = [&value](auto number) {
    value = static_cast<double>(number);
    return true;
  };
  return parse_number(word.data(), end, take) == end ? std::optional(value) : std::nullopt;
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
  const auto width = parse_side(words[0], 65536), height = parse_side(words[1], 65536);
  if (!width || !height) return;
  head.width = *width;
  head.height = *height;
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

bool is_comment(std::string_view line) {
  line.remove_prefix(std::min(line.size(), line.find_first_not_of(" \t")));
  return !line.empty() && (line[0] == '#' || line[0] == '%' || line[0] == ';' || line.starts_with("//"));
}

bool parse_line(std::string_view line, const TextLayout& layout, Event& event) {
  const char* next = line.data();
  const char* const end = next + line.size();
  for (const auto& field : layout.columns) {
    while (next != end && is_separator(*next)) ++next;
    const char* const begin = next;
    const auto skip_word = [&] {
      while (next != end && !is_separator(*next)) ++next;
    };
    if (!field) {
      skip_word();
      if (next == begin) return false;
      continue;
    }
    const auto take = [&](auto number) {
      switch (*field) {
        case table::Field::kX:
          return !table::convert_one(number, event.x);
        case table::Field::kY:
          return !table::convert_one(number, event.y);
        case table::Field::kP:
          return (event.p = layout.polarity.of(static_cast<double>(number))) != table::PolarityCode::kNone;
        default:
          return !table::convert_time(number, layout.unit, event.t);
      }
    };
    const bool may_be_word =
        *field == table::Field::kP && next != end && std::isalpha(static_cast<uint8_t>(*next)) != 0;
    if (may_be_word) {
      skip_word();
      const auto polarity = polarity_of({begin, static_cast<size_t>(next - begin)});
      if (!polarity) return false;
      event.p = *polarity;
    } else if (next = parse_number(begin, end, take); next == nullptr || (next != end && !is_separator(*next))) {
      return false;
    }
  }
  while (next != end && is_separator(*next)) ++next;
  return next == end || *next == '#';
}

}  // namespace e2lf::formats::text
