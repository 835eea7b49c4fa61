// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace e2lf::recordings::table {

/// How a table stores polarities.
struct PolarityCode {
  double off = 0, off_too = -1, on = 1;

  static constexpr uint8_t kNone = 2;
  /// 1 (ON), 0 (OFF), or kNone for a value that is neither.
  [[nodiscard]] uint8_t of(double value) const {
    return value == on ? 1 : value == off || value == off_too ? 0 : kNone;
  }
};

/// The code that explains most of some values: 0/1, -1/1, 1/2, 0/255, or -1 that was stored without a sign in any
/// width beside 1. `explained` is how many of them it explains.
struct PolarityGuess {
  PolarityCode code;
  size_t explained = 0;
  bool has_off = false, has_on = false;  ///< were seen
};
[[nodiscard]] PolarityGuess guess_polarity(std::span<const double> values);

/// Whether a value belongs to any code.
[[nodiscard]] bool is_polarity(double value);

/// "0 = OFF, 1 = ON".
[[nodiscard]] std::string polarity_text(const PolarityCode& code);

}  // namespace e2lf::recordings::table
