// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::calibrate {

/// Consecutive transitions with one joint histogram of their counts, which is row-major: the last transition changes
/// fastest. Counts beyond the range are clamped.
struct CountGroup {
  size_t first = 0, transitions = 0;
  int least_count = 0;
  size_t num_counts = 0;
  size_t begin = 0;  ///< the first of its cells among those of all groups

  [[nodiscard]] size_t size() const;  ///< number of cells
  /// Convert between a count and its position along an axis.
  [[nodiscard]] size_t place_of(int count) const {
    return static_cast<size_t>(std::clamp(count - least_count, 0, static_cast<int>(num_counts) - 1));
  }
  [[nodiscard]] int count_at(size_t place) const { return least_count + static_cast<int>(place); }
  /// Returns the cell of the counts of a cycle, count_of(transition), among those of all groups.
  template <typename CountOf>
  [[nodiscard]] size_t cell_of(const CountOf& count_of) const {
    size_t cell = 0;
    for (size_t n = first; n < first + transitions; ++n) cell = cell * num_counts + place_of(count_of(n));
    return begin + cell;
  }
};

/// Returns the groups of a cycle: the first three transitions after black, and pairs of the others. A joint histogram
/// of all of them would have too many cells.
[[nodiscard]] std::vector<CountGroup> count_groups(size_t transitions);

/// Returns the number of cells of all groups.
[[nodiscard]] size_t histogram_size(size_t transitions);

/// The light on a pixel in one cycle, J = (I + eps) / eps.
struct PixelLight {
  double inverse = 1.0;             ///< during the inverse of the last code, before black
  std::vector<double> of_patterns;  ///< one value for each pattern, from black on
  bool is_whole = false;            ///< these are the codes, their inverses and black again: see capture::whole_cycle()
};

/// Computes the joint probabilities of the counts of one cycle over pixels whose thresholds, references and noise are
/// distributed as in sensor::simulate_pixel_events(): its exact counterpart without random numbers. Given the
/// thresholds of a pixel and its reference before a group of transitions, later references follow from the counts
/// alone, and noise is independent. Probabilities of counts therefore multiply along each path. Thresholds and the
/// reference after black are integrated by quadrature with 21, 2 and 8 points. The references before later groups are
/// distributed over a grid. The total error of the probabilities of a group is at most 0.005, or 0.02 after the first
/// group, and more if the OFF threshold of a pixel is independent of its ON threshold. Paths less likely than
/// 1e-5 are omitted. `result` must have histogram_size() cells for as many transitions as there are patterns after the
/// first one.
void count_distribution(const capture::PixelConstants& constants, const PixelLight& light, std::span<double> result);

}  // namespace e2lf::calibrate
