// SPDX-License-Identifier: MIT
// Parses lines of text tables; declared in csv_layout.h.
#include <algorithm>
#include <array>
#include <cmath>

#include "e2lf/formats/text/csv_layout.h"

namespace e2lf::recordings::text {
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

}  // namespace e2lf::recordings::text
