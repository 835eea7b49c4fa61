// SPDX-License-Identifier: MIT
#include "e2lf/files/number_order.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace e2lf {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Removes the digits at the front, and returns them without leading zeros.
std::string_view take_digits(std::string_view& text) {
  const size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

/// Removes a minus at the front that is the sign of a number, and returns whether there was one.
bool take_minus(std::string_view& text, char previous) {
  const bool is_word =
      is_digit(previous) || (previous >= 'a' && previous <= 'z') || (previous >= 'A' && previous <= 'Z');
  if (is_word || text.size() < 2 || text[0] != '-' || !is_digit(text[1])) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

bool is_before_in_number_order(const std::filesystem::path& a, const std::filesystem::path& b) {
  const std::string first = a.filename().string(), second = b.filename().string();
  std::string_view x = first, y = second;
  char previous = 0;  // the last character that both names share
  while (!x.empty() && !y.empty()) {
    const bool is_x_negative = take_minus(x, previous), is_y_negative = take_minus(y, previous);
    if (is_digit(x[0]) && is_digit(y[0])) {
      if (is_x_negative != is_y_negative) return is_x_negative;
      const std::string_view m = take_digits(x), n = take_digits(y);
      if (m != n) return (m.size() != n.size() ? m.size() < n.size() : m < n) != is_x_negative;
      previous = '0';
      continue;
    }
    if (is_x_negative || is_y_negative) return is_x_negative;
    if (x[0] != y[0]) return x[0] < y[0];
    previous = x[0];
    x.remove_prefix(1);
    y.remove_prefix(1);
  }
  if (x.empty() != y.empty()) return x.empty();
  return first < second;  // 01 and 1 are different names
}

}  // namespace e2lf
