// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::recon {

/// The weight 1 of a new cycle in a mean is 2^kMeanWeightBits.
inline constexpr int kMeanWeightBits = 14;

/// The counts whose residuals are summed together, along each axis.
inline constexpr size_t kBlock = 2;

/// Returns a count in capture::kFusedUnits, limited to their range.
constexpr int units_of(int16_t count) {
  constexpr int kUnits = capture::kFusedUnits;
  return std::clamp<int>(count, INT16_MIN / kUnits, INT16_MAX / kUnits) * kUnits;
}

/// Adds the residuals units_of(counts[x]) - means[x], x < width, of a row to the sum of their block, sums[x / kBlock].
void add_residuals(const int16_t* counts, const int16_t* means, size_t width, int32_t* sums);

/// Moves the means of a row towards the counts of a new cycle by weights[x] / 2^kMeanWeightBits of their difference,
/// rounded to the nearest unit.
void add_to_means(const int16_t* counts, const int32_t* weights, size_t width, int16_t* means);

}  // namespace e2lf::recon
