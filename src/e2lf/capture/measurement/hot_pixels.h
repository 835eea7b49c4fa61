// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::capture {

/// The signed counts of each transition [transition, y, x], summed over cycles.
struct CountSums {
  Planes<int32_t> counts;
  size_t cycles = 0;

  /// Adds a cycle. The first one determines the size, which all must have.
  void add(const EventImages& cycle);
  /// Halves all sums, so that later cycles count more.
  void fade();
};

/// Calls visit(neighbour) for the up to 24 pixels of a picture that are at most two rows and columns from `pixel`. A
/// visitor that returns a bool ends the calls by false.
template <typename Visit>
void each_neighbour(size_t height, size_t width, size_t pixel, const Visit& visit) {
  constexpr size_t kReachPx = 2;
  const size_t y = pixel / width, x = pixel % width;
  for (size_t v = y < kReachPx ? 0 : y - kReachPx; v <= y + kReachPx && v < height; ++v) {
    for (size_t u = x < kReachPx ? 0 : x - kReachPx; u <= x + kReachPx && u < width; ++u) {
      if (v == y && u == x) continue;
      if constexpr (std::is_void_v<decltype(visit(pixel))>) {
        visit(v * width + u);
      } else if (!visit(v * width + u)) {
        return;
      }
    }
  }
}

/// By how much a hot pixel exceeds its neighbours.
struct HotLimits {
  float beyond_range = 1.0F;   ///< of the counts of the neighbours, in ranges of these counts
  double in_single_cycle = 3;  ///< events per transition
};

/// Returns the numbers of the hot pixels in ascending order. The limit of a pixel is the largest count of its 24
/// neighbours plus `beyond_range` times the range of their counts, both without the two most extreme ones on either
/// side, which may be hot themselves. A hot pixel exceeds it in more than half of the transitions, on average by two
/// thirds of an event per cycle and transition, and by `in_single_cycle` in a single cycle.
[[nodiscard]] std::vector<size_t> hot_pixels(const CountSums& sums, const HotLimits& limits = {});

/// Returns the number of pixels without any events among neighbours that have some: whose median is at least 20 events
/// over all cycles and transitions.
[[nodiscard]] size_t count_silent_pixels(const CountSums& sums);

/// Replaces the counts of pixels by the median of their neighbours that are not among them. `pixels` are in ascending
/// order.
void replace_by_neighbours(const std::vector<size_t>& pixels, EventImages& images);

}  // namespace e2lf::capture
