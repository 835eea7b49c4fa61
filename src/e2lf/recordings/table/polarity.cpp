// SPDX-License-Identifier: MIT
#include "e2lf/recordings/table/polarity.h"

#include <algorithm>
#include <cstdio>

#include "e2lf/base/text.h"

namespace e2lf::recordings::table {
namespace {

constexpr double kMinusOneOf64Bits = 18446744073709551616.0;  // the nearest double to 2^64 - 1

/// Of codes that match equally many values, the first is used.
constexpr PolarityCode kCodes[] = {{0, -1, 1},
                                   {1, 1, 2},
                                   {0, 0, 255},
                                   {255, 255, 1},
                                   {65535, 65535, 1},
                                   {4294967295, 4294967295, 1},
                                   {kMinusOneOf64Bits, kMinusOneOf64Bits, 1}};

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f", value);
  return value == kMinusOneOf64Bits ? "18446744073709551615" : text;
}

}  // namespace

PolarityGuess guess_polarity(std::span<const double> values) {
  PolarityGuess best;
  for (const PolarityCode& code : kCodes) {
    PolarityGuess guess{code, 0, false, false};
    for (const double value : values) {
      const uint8_t polarity = code.of(value);
      guess.explained += polarity != PolarityCode::kNone;
      guess.has_off |= polarity == 0;
      guess.has_on |= polarity == 1;
    }
    if (guess.explained > best.explained) best = guess;
  }
  // The same code is used for 0/1 and -1/1.
  if (best.code.off_too == -1 && std::count(values.begin(), values.end(), -1.0) > 0 &&
      std::count(values.begin(), values.end(), 0.0) == 0) {
    std::swap(best.code.off, best.code.off_too);
  }
  return best;
}

bool is_polarity(double value) {
  return std::any_of(std::begin(kCodes), std::end(kCodes),
                     [value](const PolarityCode& code) { return code.of(value) != PolarityCode::kNone; });
}

std::string polarity_text(const PolarityCode& code) {
  return cat(number_text(code.off), " = OFF, ", number_text(code.on), " = ON");
}

}  // namespace e2lf::recordings::table
