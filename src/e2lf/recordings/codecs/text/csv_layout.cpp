// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/text/csv_layout.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "e2lf/base/printable.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"
#include "e2lf/recordings/table/column_names.h"

namespace e2lf::recordings::text {
namespace {

bool is_utf16(std::span<const uint8_t> bytes) {
  if (bytes.size() < 4) return false;
  const bool has_mark = (bytes[0] == 0xFF && bytes[1] == 0xFE) || (bytes[0] == 0xFE && bytes[1] == 0xFF);
  const auto is_ascii = [&](size_t i) { return bytes[i] != 0 && bytes[i] < 0x80; };
  const bool is_plain = (is_ascii(0) && bytes[1] == 0 && is_ascii(2) && bytes[3] == 0) ||
                        (bytes[0] == 0 && is_ascii(1) && bytes[2] == 0 && is_ascii(3));
  return has_mark ? bytes[2] == 0 || bytes[3] == 0 : is_plain;
}

std::vector<std::string_view> lines_of(std::string_view text, char line_end, bool is_whole) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const size_t end = text.find(line_end);
    // The last line may be incomplete, unless it is the only one.
    if (end == std::string_view::npos && !is_whole && !lines.empty()) break;
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

/// Returns true if commas are decimal: other characters separate four or more numbers with commas.
bool has_decimal_commas(const std::vector<std::string_view>& lines) {
  size_t within = 0, between = 0;
  for (const std::string_view line : lines) {
    if (line.find(',') == std::string_view::npos || is_comment(line)) continue;
    bool is_within = split(line, true).size() >= 4;
    for (const std::string_view word : split(line, true)) is_within = is_within && parse_cell(word, true).has_value();
    (is_within ? within : between) += 1;
  }
  return within > between;
}

bool parse_size(std::string_view word, size_t& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && value >= 1 && value <= 65536;
}

/// Parses the sensor size in a comment: "geometry: 640,480", "sensor size 640x480", "width 640, height 480", or width
/// and height in comments of their own.
void read_size(std::string_view comment, TextHead& head) {
  const std::string lower = lower_case(comment);
  const auto has = [&](const char* word) { return lower.find(word) != std::string::npos; };
  constexpr const char* kOtherThings[] = {"pixel size", "pixel_size", "pitch",  "crop",    "tile",  "binning",
                                          "bin size",   "display",    "roi",    "preview", "frame", "kernel",
                                          "batch",      "pulse",      "ground", "file",    "board", "lens",
                                          "window",     "aperture",   "pattern"};
  if (std::any_of(std::begin(kOtherThings), std::end(kOtherThings), has)) return;
  if (!has("geometry") && !has("resolution") && !has("size") && !has("width") && !has("height")) return;
  std::vector<size_t> numbers;
  for (size_t i = 0; i < lower.size();) {
    const size_t begin = i;
    while (i < lower.size() && std::isdigit(static_cast<unsigned char>(lower[i])) != 0) ++i;
    size_t number = 0;
    if (i > begin && parse_size(std::string_view(lower).substr(begin, i - begin), number)) numbers.push_back(number);
    if (i == begin) ++i;
  }
  if (numbers.size() == 1 && has("width") != has("height")) {
    (has("width") ? head.width : head.height) = numbers[0];
    return;
  }
  if (numbers.size() != 2) return;
  const std::vector<std::string> words = table::words_of(comment);
  const auto place_of = [&](std::initializer_list<std::string_view> names) {
    return std::find_if(words.begin(), words.end(), [&](const auto& word) { return table::is_one_of(word, names); });
  };
  if (place_of({"h", "height", "hxw"}) < place_of({"w", "width", "wxh"})) std::swap(numbers[0], numbers[1]);
  head.width = numbers[0];
  head.height = numbers[1];
}

/// Removes what introduces the names in a line: "# Format is t, x, y, p", "# columns: x y t p".
std::string_view without_label(std::string_view line) {
  line.remove_prefix(std::min(line.size(), line.find_first_not_of("#%/; \t\xEF\xBB\xBF")));
  for (const std::string_view end : {": ", " is ", "= "}) {
    const size_t place = line.find(end);
    if (place == std::string_view::npos) continue;
    const std::vector<std::string> label = table::words_of(line.substr(0, place));
    const auto introduces = [](const std::string& word) {
      return table::is_one_of(word, {"format", "columns", "fields", "line", "order"});
    };
    if (std::any_of(label.begin(), label.end(), introduces)) return line.substr(place + end.size());
  }
  return line;
}

/// Returns the names in a line, which are separated by commas, semicolons, bars or tabs, or else by blanks. What stands
/// in brackets behind a name belongs to it, unless a bracket is not closed. If the line begins with a comma, the first
/// name is empty.
std::vector<std::string> names_in(std::string_view line, bool has_decimal_comma, bool has_brackets = true) {
  line = without_label(line);
  const auto has = [line](char c) { return line.find(c) != std::string_view::npos; };
  const char separator = !has_decimal_comma && has(',') ? ','
                         : has(';')                     ? ';'
                         : has('|')                     ? '|'
                         : has('\t')                    ? '\t'
                                                        : ' ';
  std::vector<std::string> names(1);
  size_t depth = 0;
  for (const char c : line) {
    const bool is_within = names.back().find_first_not_of(" \t") != std::string::npos;
    const bool is_behind = is_within || (separator == ' ' && names.size() > 1);
    if (has_brackets && is_behind && std::string_view("([{").find(c) != std::string_view::npos) {
      if (!is_within) names.pop_back();
      ++depth;
    }
    if (depth > 0 && std::string_view(")]}").find(c) != std::string_view::npos) --depth;
    if (c != separator || depth > 0) {
      names.back() += c;
    } else if (separator != ' ' || is_within) {
      names.emplace_back();
    }
  }
  if (depth > 0) return names_in(line, has_decimal_comma, false);
  while (!names.empty() && names.back().find_first_not_of(" \r\n") == std::string::npos) names.pop_back();
  return names;
}

bool are_column_names(const std::vector<std::string>& names) {
  const table::KnownColumns known = table::find_fields(names);
  return std::count_if(known.begin(), known.end(), [](const auto& column) { return column.has_value(); }) >= 2;
}

/// Sets the names of the columns from a line that has one name for each column, of which at least two are known.
bool take_names(std::string_view line, TextHead& head) {
  const std::vector<std::string> names = names_in(line, head.has_decimal_comma);
  if (names.size() != head.columns || !are_column_names(names)) return false;
  for (size_t i = 0; i < names.size(); ++i) head.sample.columns[i].name = names[i];
  return true;
}

/// Sets the unit of the times from a line below the names, such as "us,px,px,-".
bool take_unit(const std::vector<std::string_view>& words, TextHead& head) {
  if (words.size() != head.columns) return false;
  bool is_taken = false;
  for (size_t i = 0; i < words.size(); ++i) {
    table::TableSample::Column& column = head.sample.columns[i];
    const std::vector<std::string> unit_words = table::words_of(words[i]);  // "[us]"
    const TimeUnit unit = unit_words.size() == 1 ? table::parse_time_unit(unit_words[0]) : TimeUnit::kAuto;
    if (unit == TimeUnit::kAuto || table::parse_column_name(column.name).field != table::Field::kT) continue;
    column.unit = unit;
    is_taken = true;
  }
  return is_taken;
}

struct Cells {
  std::vector<std::string_view> words;
  std::vector<double> values = {};  ///< one for each word; NaN if it is not a number
  size_t numbers = 0;
  /// Returns true if there are enough numbers for an event; other columns may contain text.
  [[nodiscard]] bool are_numbers() const { return numbers >= table::kNumFields; }
};

Cells cells_of(std::string_view line, bool has_decimal_comma) {
  Cells cells{split(line, has_decimal_comma)};
  for (const std::string_view word : cells.words) {
    const auto value = parse_cell(word, has_decimal_comma);
    cells.values.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
    cells.numbers += value.has_value();
  }
  return cells;
}

/// Returns true if a word has six decimals, as times in seconds have that e2lf and E2VID write.
bool has_six_decimals(std::string_view word) {
  const size_t point = word.find('.');
  return point != std::string_view::npos && word.size() - point == 7 &&
         word.find_first_of("eE") == std::string_view::npos;
}

/// Returns the value of the last digit of a number.
double step_of(std::string_view word) {
  const size_t mark = std::min(word.find_first_of("eE"), word.size());
  const size_t point = word.find_first_of(".,");
  const auto decimals = point < mark ? static_cast<int>(mark - point) - 1 : 0;
  int exponent = 0;
  if (mark < word.size()) {
    const size_t begin = word.find_first_not_of("eE+", mark);
    std::from_chars(word.data() + std::min(begin, word.size()), word.data() + word.size(), exponent);
  }
  return std::pow(10.0, exponent - decimals);
}

/// Sets the steps of the columns from the large values in the lines of numbers.
void find_steps(const std::vector<Cells>& lines, TextHead& head) {
  constexpr double kLarge = 0.9;
  for (size_t column = 0; column < head.columns; ++column) {
    table::TableSample::Column& sample = head.sample.columns[column];
    double largest = 0;
    for (const double value : sample.values) largest = std::max(largest, std::fabs(value));
    for (const Cells& cells : lines) {
      if (!cells.are_numbers() || cells.words.size() != head.columns) continue;
      if (largest == 0 || !(std::fabs(cells.values[column]) >= kLarge * largest)) continue;
      const double step = step_of(cells.words[column]);
      if (sample.step == 0 || step < sample.step) sample.step = step;
    }
  }
}

}  // namespace

std::string quoted(std::string_view line) {
  constexpr size_t kMost = 60;
  return cat('"', printable(line.substr(0, kMost)), line.size() > kMost ? "...\"" : "\"");
}

Result<TextHead> read_head(std::span<const uint8_t> bytes, bool is_whole, const std::string& location) {
  if (is_utf16(bytes)) {
    return Error{ErrorCode::kUnsupported, "the text is encoded as UTF-16; save it as UTF-8 or ASCII", location};
  }
  TextHead head;
  const std::string_view text = as_text(bytes);
  const auto count_of = [&](char c) { return std::count(text.begin(), text.end(), c); };
  if (count_of('\n') == 0 && count_of('\r') > 0) head.line_end = '\r';
  const std::vector<std::string_view> lines = lines_of(text, head.line_end, is_whole);
  head.has_decimal_comma = has_decimal_commas(lines);

  // The number of columns is that of most lines.
  std::vector<Cells> cells;
  std::map<size_t, size_t> widths;
  for (const std::string_view marked : lines) {
    const std::string_view line = without_mark(marked);
    cells.push_back(is_comment(line) ? Cells() : cells_of(line, head.has_decimal_comma));
    if (cells.back().are_numbers()) ++widths[cells.back().words.size()];
  }
  const auto most =
      std::max_element(widths.begin(), widths.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most != widths.end()) head.columns = most->first;
  head.sample.columns.resize(head.columns);

  TimeUnit unit = TimeUnit::kAuto;
  const auto take_times = [&](std::string_view line) {
    const table::TimeStatement told = table::times_in_sentence(line);
    if (unit == TimeUnit::kAuto) unit = told.unit;
    if (head.sample.tick_s == 0) head.sample.tick_s = told.tick_s;
    const table::PolarityStatement polarities = table::polarities_in_sentence(line);
    if (!head.sample.polarities.on) head.sample.polarities.on = polarities.on;
    if (!head.sample.polarities.off) head.sample.polarities.off = polarities.off;
    return told.unit != TimeUnit::kAuto || told.tick_s > 0;
  };
  bool has_begun = false, has_names = false, has_size_line = false, has_point = false, are_six = true;
  for (size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = without_mark(lines[i]);
    const auto place = static_cast<size_t>(lines[i].data() - text.data());
    const size_t end = std::min(place + lines[i].size() + 1, text.size());
    const std::vector<std::string_view>& words = cells[i].words;
    const bool is_data = cells[i].are_numbers() && words.size() == head.columns;
    size_t width = 0, height = 0;
    if (is_comment(line)) {
      if (!has_begun && !has_names) has_names = take_names(line, head);
      if (!has_begun) read_size(line, head);
      if (!has_begun && line.starts_with("%geometry")) head.sample.usual_order = "xypt";
      take_times(line);
    } else if (words.empty() || (line == head.names_line && has_begun)) {
      continue;
    } else if (!has_begun && words.size() == 2 && parse_size(words[0], width) && parse_size(words[1], height)) {
      head.width = width;
      head.height = height;
      has_size_line = true;
      head.names_line = line;
    } else if (!has_begun && !is_data && has_names && take_unit(words, head)) {
    } else if (const bool names = !has_begun && !is_data && !has_names && take_names(line, head);
               names || (!has_begun && !is_data && (take_times(line) || cells[i].numbers == 0))) {
      if (names) take_times(line);
      if (names || !has_names) head.names_line = line;
      has_names |= names;
      if (head.columns == 0 && head.first_bad.empty() && !are_column_names(names_in(line, head.has_decimal_comma))) {
        head.first_bad_number = i + 1;
        head.first_bad = quoted(line);
      }
    } else {
      if (!has_begun) head.header_bytes = place;
      has_begun = true;
      ++head.lines;
      if (is_data) {
        const bool is_first_six = has_six_decimals(words[0]);
        for (size_t column = 0; column < head.columns; ++column) {
          const bool is_number = !std::isnan(cells[i].values[column]);
          has_point |= is_number && words[column].find_first_of(".,eE") != std::string_view::npos;
        }
        are_six = are_six && is_first_six;
        for (size_t column = 0; column < head.columns; ++column) {
          head.sample.columns[column].values.push_back(cells[i].values[column]);
        }
      } else if (head.bad_lines++ == 0) {
        head.first_bad_number = i + 1;
        head.first_bad = quoted(line);
      }
    }
    if (!has_begun) head.header_bytes = end;
  }
  if (!has_begun && lines.empty()) head.header_bytes = 0;
  if (head.width == 0 || head.height == 0) head.width = head.height = 0;
  for (table::TableSample::Column& column : head.sample.columns) {
    if (column.unit == TimeUnit::kAuto) column.unit = unit;
  }
  for (table::TableSample::Column& column : head.sample.columns) column.is_integer = !has_point;
  find_steps(cells, head);
  const bool has_commas =
      !head.has_decimal_comma && text.find_first_of(",;", head.header_bytes) != std::string_view::npos;
  if (head.sample.usual_order.empty()) head.sample.usual_order = has_commas ? "xypt" : "txyp";
  head.has_six_decimals = head.lines > 0 && are_six;
  if (has_size_line && head.has_six_decimals && !has_names) head.sample.usual_unit = TimeUnit::kSeconds;
  return head;
}

}  // namespace e2lf::recordings::text
