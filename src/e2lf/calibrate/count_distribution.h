// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::calibrate {

/// The range of counts of one transition that a histogram distinguishes. Counts beyond it are clamped.
inline constexpr int kLeastCount = -4, kMostCount = 7;
inline constexpr size_t kNumCounts = kMostCount - kLeastCount + 1;
inline constexpr size_t kMostTransitions = 3;

/// Returns the number of cells of the joint histogram of this number of transitions. It is row-major: the last
/// transition changes fastest.
[[nodiscard]] size_t histogram_size(size_t transitions);
/// Convert between a count and its position along an axis.
[[nodiscard]] size_t count_place(int count);
[[nodiscard]] inline int count_at(size_t place) {
  return kLeastCount + static_cast<int>(place);
}

/// The light on a pixel in one cycle, J = (I + eps) / eps.
struct PixelLight {
  double inverse = 1.0;             ///< during the inverse of the last pattern, before black
  std::vector<double> of_patterns;  ///< from black on
};

/// Computes the joint probability of the counts of one cycle over pixels whose thresholds, references and noise are
/// distributed as in sensor::simulate_pixel_events(): its exact counterpart without random numbers. Given the
/// thresholds of a pixel and its reference after black, later references follow from the counts alone, and noise is
/// independent. Probabilities of counts therefore multiply along each path. Thresholds and the reference are integrated
/// by quadrature with 21, 2 and 8 points; the total error of the probabilities is at most 0.005. Paths less likely than
/// 1e-5 are omitted. `result` must have histogram_size() cells for as many transitions as there are active patterns, 1
/// to kMostTransitions.
void count_distribution(const capture::PixelConstants& constants, const PixelLight& light, std::span<double> result);

}  // namespace e2lf::calibrate
