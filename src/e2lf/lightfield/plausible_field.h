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

/// Whether numbers that were read are those of a light field. What cannot be one is an error; what is hardly one is
/// said on the log, with what was found.
namespace e2lf::lightfield {

/// What is nearer to [0, 1] is a rounding error.
inline constexpr float kRangeTolerance = 1e-3F;

/// False for NaN, infinity, and what the policy refuses; brings the rest where the policy wants it.
[[nodiscard]] inline bool settle(float& value, RangePolicy policy) {
  if (policy == RangePolicy::kKeep) return std::fabs(value) <= kMostKept;
  const float clamped = std::clamp(value, 0.0F, 1.0F);
  const bool good =
      policy == RangePolicy::kClamp ? std::fabs(value) <= kMostKept : std::fabs(value - clamped) <= kRangeTolerance;
  value = clamped;
  return good;
}

/// Samples of which some are not in the range that was asked for.
struct BadSamples {
  std::string first;                                                ///< the first of these and where it is
  float low = std::numeric_limits<float>::infinity(), high = -low;  ///< of those that are finite, as stored
  size_t not_finite = 0;

  void add(float stored);
  /// Says what is wrong, and what to do: kInvalidValue.
  [[nodiscard]] Error error(const std::string& location) const;
};

/// Checks a light field against the number that was taken as white because nobody named one, 0 = somebody did. Fails
/// with kInvalidValue where the integers are those of a smaller type: 0 and 1 of 8 bits, 0 to 255 of 16 bits. Warns
/// where they need fewer bits than they have, where values hardly differ, and where many lie outside of [0, 1].
[[nodiscard]] Result<void> check_values(const LightField& light_field, float assumed_white,
                                        const std::string& location);

/// Fails with kShape where more than 32 views of each axis have fewer pixels than there are views: the axes are in
/// another order. Warns where fewer views have.
[[nodiscard]] Result<void> check_axes(const Shape& stored, const std::string& location);

}  // namespace e2lf::lightfield
