// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/capture/profile/camera.h"

namespace e2lf::calibrate {

/// Counts of one transition that a histogram tells apart; what lies beyond is taken for the outermost.
inline constexpr int kLeastCount = -4, kMostCount = 7;
inline constexpr size_t kNumCounts = kMostCount - kLeastCount + 1;
inline constexpr size_t kMostTransitions = 3;

/// Cells of the joint histogram of so many transitions, row-major: the last transition changes fastest.
[[nodiscard]] size_t histogram_size(size_t transitions);
/// The place of a count along its axis, and the count of a place.
[[nodiscard]] size_t count_place(int count);
[[nodiscard]] inline int count_at(size_t place) {
  return kLeastCount + static_cast<int>(place);
}

/// The light of one cycle on a pixel, J = (I + eps) / eps.
struct PixelLight {
  double inverse = 1.0;             ///< while the inverse of the last pattern is shown, before black
  std::vector<double> of_patterns;  ///< from black on
};

/// The joint probability of the counts of one cycle, over pixels whose thresholds, references and noises are drawn as
/// sensor::simulate_pixel_events() draws them: its exact counterpart, without random numbers. Given the thresholds of a
/// pixel and its reference after black, the reference later follows from the counts alone; noises are independent. So
/// probabilities of counts multiply along each path. What is left, thresholds and reference, is integrated by rules of
/// 21, 2 and 8 points: the probabilities are off by 0.005 in total at most. Paths less likely than 1e-5 are left out.
/// `result` has histogram_size() cells for as many transitions as there are lit patterns, 1 to kMostTransitions.
void count_distribution(const capture::PixelConstants& constants, const PixelLight& light, std::span<double> result);

}  // namespace e2lf::calibrate
