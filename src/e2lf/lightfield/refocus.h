// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

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

/// A synthetic aperture: a non-negative weight for each view [view_y, view_x]. The sum of the weights is the light that
/// it lets through.
struct Aperture {
  size_t views_y = 0, views_x = 0;
  std::vector<float> weights;
};

/// Returns an aperture with weight 1 for every view.
[[nodiscard]] Aperture full_aperture(const Shape& shape);

/// A disc in the plane of the aperture, in view steps from its middle ((views - 1) / 2 on each axis). Its rim is one
/// view step wide: weight = clamp(radius + 0.5 - distance, 0, 1), so that the picture changes smoothly with the radius.
struct RoundAperture {
  float radius = 0;
  float centre_y = 0, centre_x = 0;  ///< offset of the disc from the middle, which changes the viewpoint
};
[[nodiscard]] Aperture round_aperture(const Shape& shape, const RoundAperture& disc);

/// Computes the picture of a camera with this aperture, focused at `disparity` (px per view step) and seen from the
/// middle of the view grid: out(y, x) = sum_v w_v L_v(y + d (v_y - m_y), x + d (v_x - m_x)) / sum_v w_v, where m =
/// (views - 1) / 2. A plane of disparity d appears sharp, at its position in the middle of the grid. Fractional shifts
/// are interpolated by Catmull-Rom cubics, and pixels outside of a view are replaced by the nearest one inside. The
/// result does not depend on the number of threads. An aperture of another size, a negative weight or zero total weight
/// breaks the contract.
[[nodiscard]] Image refocus(const LightFieldView& light_field, float disparity, const Aperture& aperture);

}  // namespace e2lf::lightfield
