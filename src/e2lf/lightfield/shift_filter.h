// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace e2lf::lightfield {

inline constexpr int kShiftTaps = 4;

/// A fractional shift along one axis: out[i] = sum_k taps[k] * in[i + first + k].
struct ShiftFilter {
  ptrdiff_t first = 0;
  std::array<float, kShiftTaps> taps{};
};

/// Returns the Catmull-Rom filter for a shift by `shift` px, clamped to +-1e6 px. A whole shift copies the pixels.
[[nodiscard]] inline ShiftFilter make_shift_filter(float shift) {
  constexpr float kFarOutside = 1e6F;  // No view is that large, and the shift fits into any integer type.
  shift = std::clamp(shift, -kFarOutside, kFarOutside);
  const float whole = std::floor(shift);
  const float t = shift - whole, t2 = t * t, t3 = t2 * t;
  return {static_cast<ptrdiff_t>(whole) - 1,
          {0.5F * (-t + 2 * t2 - t3), 0.5F * (2 - 5 * t2 + 3 * t3), 0.5F * (t + 4 * t2 - 3 * t3), 0.5F * (t3 - t2)}};
}

}  // namespace e2lf::lightfield
