// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/formats/view_names.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string_view>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/axes.h"

namespace e2lf::lightfield {
namespace fs = std::filesystem;
namespace {

constexpr size_t kMaxNumber = 9999;

/// Removes a number from the front of `text`. Returns false if there is none or if it is too large.
bool take_number(std::string_view& text, size_t& number) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc() || number > kMaxNumber) return false;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return true;
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

std::string padded(size_t number, size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

constexpr size_t kMostViewsPerAxis = 10000;

/// Returns the whole number of a line `key = 9` in parameters.cfg, or 0 if there is none.
size_t setting_of(const fs::path& file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const size_t equals = line.find('=');
    const size_t begin = line.find_first_not_of(" \t");
    if (equals == std::string::npos || begin == std::string::npos) continue;
    if (line.substr(begin, line.find_last_not_of(" \t", equals - 1) + 1 - begin) != key) continue;
    const unsigned long value = std::strtoul(line.c_str() + equals + 1, nullptr, 10);
    return value <= kMostViewsPerAxis ? value : 0;
  }
  return 0;
}

/// Returns the grid with this number of columns. If the numbers end at the end of a row but begin within one, the first
/// views are missing.
FlatGrid grid_of_columns(size_t first, size_t last, size_t columns, size_t rows) {
  const size_t span = last - first + 1, whole = (span + columns - 1) / columns * columns;
  const bool lacks_first = span < whole && (last + 1) % columns == 0 && last + 1 >= whole;
  return {lacks_first ? last + 1 - whole : first, columns, rows};
}

/// Returns the distance between rows that have equally many numbers and equal gaps between them, or 0 if the numbers do
/// not have this form.
size_t row_distance(const std::vector<size_t>& numbers) {
  std::vector<size_t> begins;
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (i == 0 || numbers[i] != numbers[i - 1] + 1) begins.push_back(i);
  }
  if (begins.size() < 2 || begins[1] < 2 || numbers.size() != begins.size() * begins[1]) return 0;
  const size_t distance = numbers[begins[1]] - numbers[0];
  for (size_t row = 1; row < begins.size(); ++row) {
    if (begins[row] != row * begins[1] || numbers[begins[row]] != numbers[0] + row * distance) return 0;
  }
  // A square with one view missing in the middle also has two such rows.
  const bool may_be_square = begins.size() == 2 && views_per_axis(numbers.back() - numbers.front() + 1) > 0;
  return may_be_square ? 0 : distance;
}

}  // namespace

bool is_image_name(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

std::optional<NumberedView> parse_view_name(const std::filesystem::path& file) {
  if (!is_image_name(file)) return std::nullopt;
  const std::string stem = lower_case(file.stem().string());
  std::string_view rest = stem;
  if (take_prefix(rest, "input_cam")) {
    size_t number = 0;
    if (!take_number(rest, number) || !rest.empty()) return std::nullopt;
    return NumberedView{LightFieldKind::kHciFolder, 0, number};
  }
  const LightFieldKind kind = take_prefix(rest, "out_") ? LightFieldKind::kStanfordFolder : LightFieldKind::kViewFolder;
  size_t row = 0, column = 0;
  if (!take_number(rest, row) || !take_prefix(rest, "_") || !take_number(rest, column)) return std::nullopt;
  const bool position_follows = kind == LightFieldKind::kStanfordFolder && rest.starts_with("_");
  if (!rest.empty() && !position_follows) return std::nullopt;
  return NumberedView{kind, row, column};
}

std::optional<PairName> parse_pair_name(const std::filesystem::path& file) {
  if (!is_image_name(file)) return std::nullopt;
  const std::string stem = lower_case(file.stem().string());
  std::string words;
  std::vector<size_t> numbers;
  for (std::string_view rest = stem; !rest.empty();) {
    const bool is_digit = rest[0] >= '0' && rest[0] <= '9';
    size_t number = 0;
    if (is_digit && (numbers.size() == 2 || !take_number(rest, number))) return std::nullopt;
    if (is_digit) numbers.push_back(number);
    words += is_digit ? '#' : rest[0];
    if (!is_digit) rest.remove_prefix(1);
  }
  // Adjacent numbers would be one.
  if (numbers.size() != 2) return std::nullopt;
  const std::string front = words.substr(0, words.find('#'));
  const std::string word = front.substr(front.find_last_not_of("abcdefghijklmnopqrstuvwxyz") + 1);
  const bool is_column_first = word == "x" || word == "u" || word == "c" || word.starts_with("col");
  return PairName{words, numbers[is_column_first ? 1 : 0], numbers[is_column_first ? 0 : 1], is_column_first};
}

std::string view_name(LightFieldKind kind, size_t row, size_t column) {
  if (kind == LightFieldKind::kHciFolder) return cat("input_Cam", padded(kHciColumns * row + column, 3), ".png");
  if (kind == LightFieldKind::kStanfordFolder) return cat("out_", padded(row, 2), "_", padded(column, 2), "_*.png");
  return cat(padded(row, 2), "_", padded(column, 2), ".png");
}

std::string numbered_view_name(const std::filesystem::path& like, size_t number) {
  const std::string stem = like.stem().string();
  const size_t digits = stem.size() - std::string_view("input_Cam").size();
  return cat(stem.substr(0, stem.size() - digits), padded(number, digits), like.extension().string());
}

std::string written_view_name(LightFieldKind kind, size_t row, size_t column) {
  if (kind != LightFieldKind::kStanfordFolder) return view_name(kind, row, column);
  return cat("out_", padded(row, 2), "_", padded(column, 2), "_-", row, ".000000_-", column, ".000000.png");
}

Result<FlatGrid> find_flat_grid(const std::vector<size_t>& numbers, size_t columns, const fs::path& folder) {
  const size_t first = numbers.front(), last = numbers.back(), span = last - first + 1;
  if (columns > 0) return grid_of_columns(first, last, columns, 0);
  const fs::path config = folder / "parameters.cfg";
  const size_t said_columns = setting_of(config, "num_cams_x"), said_rows = setting_of(config, "num_cams_y");
  if (said_columns > 0 && said_rows > 0) {
    FlatGrid grid = grid_of_columns(first, last, said_columns, said_rows);
    const size_t views = said_columns * said_rows;
    // The benchmark numbers from 0, so a grid that lacks its first views begins there.
    if (last < views) grid.first = 0;
    if (last - grid.first < views) return grid;
    return Error{ErrorCode::kShape,
                 cat("the file states ", said_columns, "x", said_rows, " views, but the views are numbered from ",
                     first, " to ", last, "; correct num_cams_x and num_cams_y, or give the number of view columns"),
                 config.string()};
  }
  if (const size_t distance = row_distance(numbers)) return FlatGrid{first, distance, 0};
  if (const size_t side = views_per_axis(span)) return FlatGrid{first, side, 0};
  return Error{ErrorCode::kInvalidValue,
               cat(numbers.size(), " views are numbered consecutively from ", first, " to ", last,
                   ", which is not a square grid; give the number of view columns, or copy the "
                   "missing views"),
               folder.string()};
}

}  // namespace e2lf::lightfield
