// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::recon {

/// The weight of a new cycle in the mean of 1 to kMostFusedCycles cycles, in units of 2^-15. That of the first one, 1,
/// is kWholeWeight, because 2^15 does not fit.
constexpr int16_t kWholeWeight = INT16_MAX;
constexpr int16_t mean_weight(size_t cycles) {
  return cycles == 1 ? kWholeWeight : static_cast<int16_t>((1U << 15) / cycles);
}

/// The counts whose residuals are summed together, along each axis.
inline constexpr size_t kBlock = 2;

/// Returns a count in capture::kFusedUnits, limited to their range.
constexpr int16_t units_of(int16_t count) {
  constexpr int kUnits = capture::kFusedUnits;
  return static_cast<int16_t>(std::clamp<int>(count, INT16_MIN / kUnits, INT16_MAX / kUnits) * kUnits);
}

using TwoRows = std::array<const int16_t*, kBlock>;

/// Sets the sums of each block, sums[x / kBlock], x < width, to those of the residuals units_of(counts[row][x]) -
/// means[row][x] in its rows.
void block_residuals(const TwoRows& counts, const TwoRows& means, size_t width, int32_t* sums);

/// Moves the means of a row towards the counts of a new cycle by their difference, which saturates in 16 bits, times
/// weights[x], as of mean_weight(), rounded to the nearest unit.
void add_to_means(const int16_t* counts, const int16_t* weights, size_t width, int16_t* means);

/// Adds the squares of the residuals of the two blocks of each cell, residuals[2 * x] and [2 * x + 1], to of_blocks[x],
/// and the residuals to sums[x].
void add_squares(const int32_t* residuals, size_t cells, float* of_blocks, float* sums);

/// Sets sums[x], x < count, to the sum of rows[i][x] over at least one row.
void sum_rows(std::span<const float* const> rows, size_t count, float* sums);

}  // namespace e2lf::recon
