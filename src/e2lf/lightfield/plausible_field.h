// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/lightfield/light_field_io.h"

/// Checks whether the numbers that were read are plausible for a light field. Impossible values are errors. Implausible
/// ones are logged as warnings, together with what was found.
namespace e2lf::lightfield {

/// Deviations from [0, 1] up to this size are rounding errors.
inline constexpr float kRangeTolerance = 1e-3F;

/// Returns false for NaN, infinity and values that the policy refuses, and clamps the others if the policy requires it.
[[nodiscard]] inline bool settle(float& value, RangePolicy policy) {
  if (policy == RangePolicy::kKeep) return std::fabs(value) <= kMostKept;
  const float clamped = std::clamp(value, 0.0F, 1.0F);
  const bool good =
      policy == RangePolicy::kClamp ? std::fabs(value) <= kMostKept : std::fabs(value - clamped) <= kRangeTolerance;
  value = clamped;
  return good;
}

/// Collects samples, some of which are outside of the requested range.
struct BadSamples {
  std::string first;                                                ///< the first sample out of range and its place
  float low = std::numeric_limits<float>::infinity(), high = -low;  ///< range of the finite samples, as stored
  size_t not_finite = 0;

  void add(float stored);
  /// Describes the problem and its remedy, as an error of kind kInvalidValue.
  [[nodiscard]] Error error(const std::string& location) const;
};

/// Checks the values of a light field against the assumed white, i.e. the stored number that was taken as 1 because
/// none was named (0 = one was named). Fails with kInvalidValue if the integers are those of a smaller type: 0 and 1 in
/// 8 bits, or 0 to 255 in 16 bits. Warns if they use fewer bits than they have, if the values hardly differ, and if
/// many of them lie outside of [0, 1].
[[nodiscard]] Result<void> check_values(const LightField& light_field, float assumed_white,
                                        const std::string& location);

/// Checks that views have at least as many pixels as there are views along each axis. If they do not, the axes are
/// probably in another order: fails with kShape if an axis has more than 32 views, and warns otherwise.
[[nodiscard]] Result<void> check_axes(const Shape& stored, const std::string& location);

}  // namespace e2lf::lightfield
