// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/text/csv_layout.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

namespace e2lf::recordings::text {
namespace {

constexpr int64_t kTimeLimitUs = int64_t{1} << 62;

bool is_separator(char c) {
  return c == ',' || c == ' ' || c == ';' || c == '\t' || c == '\r';
}

bool is_digit(char c) {
  return static_cast<unsigned char>(c - '0') < 10;
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

bool parse_size(std::string_view word, size_t& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && value >= 1 && value <= 65536;
}

/// "x", "y", "p" or "polarity", "t" or "timestamp" in some order.
bool parse_names(const std::vector<std::string_view>& words, Layout& layout) {
  if (words.size() != 4) return false;
  auto order = layout.order;
  std::array<bool, 4> seen{};
  for (size_t i = 0; i < 4; ++i) {
    const char first = static_cast<char>(words[i][0] | 0x20);
    const size_t field = std::string_view("xypt").find(first);
    if (field == std::string_view::npos || seen[field]) return false;
    seen[field] = true;
    order[i] = static_cast<Field>(field);
  }
  layout.order = order;
  return true;
}

/// A whole number with an optional sign at `next`, which moves behind it.
bool parse_integer(const char*& next, const char* end, int64_t& value) {
  const bool negative = next != end && *next == '-';
  next += negative;
  if (next == end || !is_digit(*next)) return false;
  value = 0;
  for (; next != end && is_digit(*next); ++next) {
    if (value >= kTimeLimitUs / 10) return false;
    value = value * 10 + (*next - '0');
  }
  if (negative) value = -value;
  return true;
}

/// Seconds as microseconds, rounded: digits, maybe a point and more digits; an exponent is taken by the slow way.
bool parse_seconds(const char*& next, const char* end, int64_t& value_us) {
  const char* const begin = next;
  const bool negative = next != end && *next == '-';
  int64_t seconds = 0;
  if (!parse_integer(next, end, seconds) || seconds > kTimeLimitUs / 1'000'000 || seconds < -kTimeLimitUs / 1'000'000) {
    return false;
  }
  int64_t fraction = 0;
  if (next != end && *next == '.') {
    ++next;
    int digits = 0;
    for (; next != end && is_digit(*next); ++next, ++digits) {
      if (digits < 6) fraction = fraction * 10 + (*next - '0');
      if (digits == 6) fraction += *next >= '5';
    }
    for (; digits < 6; ++digits) fraction *= 10;
  }
  if (next != end && (*next == 'e' || *next == 'E')) {
    double number = 0;
    const auto [after, error] = std::from_chars(begin, end, number);
    if (error != std::errc() || !(number > -4e12 && number < 4e12)) return false;
    next = after;
    value_us = static_cast<int64_t>(number * 1e6 + (negative ? -0.5 : 0.5));
    return true;
  }
  value_us = seconds * 1'000'000 + (negative ? -fraction : fraction);
  return true;
}

void skip_fraction(const char*& next, const char* end) {
  if (next == end || *next != '.') return;
  ++next;
  while (next != end && *next == '0') ++next;
}

}  // namespace

bool parse_line(std::string_view line, const Layout& layout, Event& event) {
  const char* next = line.data();
  const char* const end = next + line.size();
  std::array<int64_t, 4> values;
  for (const Field field : layout.order) {
    while (next != end && is_separator(*next)) ++next;
    int64_t& value = values[static_cast<size_t>(field)];
    if (field == Field::kT && layout.is_seconds) {
      if (!parse_seconds(next, end, value)) return false;
    } else {
      if (!parse_integer(next, end, value)) return false;
      skip_fraction(next, end);
    }
    if (next != end && !is_separator(*next)) return false;
  }
  while (next != end && is_separator(*next)) ++next;
  const auto [x, y, p, t] = values;
  if (next != end || x < 0 || x > UINT16_MAX || y < 0 || y > UINT16_MAX || p < -1 || p > 1) return false;
  event = {static_cast<uint16_t>(x), static_cast<uint16_t>(y), static_cast<uint8_t>(p > 0), t};
  return true;
}

std::optional<Layout> find_layout(std::span<const uint8_t> head) {
  Layout layout;
  bool has_names = false;
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    const std::vector<std::string_view> words = split(line);
    layout.header_bytes = begin;
    begin = end + 1;
    if (line.starts_with("%geometry:")) {
      const std::vector<std::string_view> sizes = split(line.substr(10));
      if (sizes.size() != 2 || !parse_size(sizes[0], layout.width) || !parse_size(sizes[1], layout.height)) return {};
    } else if (words.empty() || line[0] == '#' || line[0] == '%') {
      continue;
    } else if (words.size() == 2 && !has_names && layout.width == 0) {
      if (!parse_size(words[0], layout.width) || !parse_size(words[1], layout.height)) return {};
      layout.order = kTxtOrder;
      layout.is_seconds = true;
    } else if (!has_names && parse_names(words, layout)) {
      has_names = true;
    } else {
      if (words.size() != 4) return {};
      const bool first_has_point = words[0].find('.') != std::string_view::npos;
      if (!has_names && first_has_point) layout.order = kTxtOrder;
      const auto time_at = std::find(layout.order.begin(), layout.order.end(), Field::kT) - layout.order.begin();
      layout.is_seconds |= words[static_cast<size_t>(time_at)].find('.') != std::string_view::npos;
      Event event;
      if (!parse_line(line, layout, event)) return {};
      layout.has_events = true;
      return layout;
    }
    layout.header_bytes = std::min(begin, text.size());
  }
  if (layout.width == 0) return {};
  return layout;
}

}  // namespace e2lf::recordings::text
