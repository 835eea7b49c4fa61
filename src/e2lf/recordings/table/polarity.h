// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace e2lf::recordings::table {

/// The code of polarities in a table.
struct PolarityCode {
  double off = 0, off_too = -1, on = 1;

  static constexpr uint8_t kNone = 2;
  /// Returns 1 (ON), 0 (OFF), or kNone for a value that is neither.
  [[nodiscard]] uint8_t of(double value) const {
    return value == on ? 1 : value == off || value == off_too ? 0 : kNone;
  }
};

/// Finds the code that matches most of the values: 0/1, -1/1, 1/2, 0/255, or 1 together with -1 that was stored as an
/// unsigned number of any width. `explained` is the number of matching values.
struct PolarityGuess {
  PolarityCode code;
  size_t explained = 0;
  bool has_off = false, has_on = false;  ///< whether such values occurred
};
[[nodiscard]] PolarityGuess guess_polarity(std::span<const double> values);

/// Returns whether a value belongs to any code.
[[nodiscard]] bool is_polarity(double value);

/// Returns "0 = OFF, 1 = ON" or the like.
[[nodiscard]] std::string polarity_text(const PolarityCode& code);

}  // namespace e2lf::recordings::table
