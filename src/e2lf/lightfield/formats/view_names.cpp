// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/formats/view_names.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <vector>

#include "e2lf/base/text.h"

namespace e2lf::lightfield {
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

}  // namespace e2lf::lightfield
