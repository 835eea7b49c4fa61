// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::recon {

/// Where the upper left pixel of an image lies on a network's grid.
struct GridShift {
  size_t y = 0, x = 0;
  bool operator==(const GridShift&) const = default;
};

/// The first `count` of the shifts that a network with `size_multiple` tells apart, none twice; all size_multiple^2 of
/// them when `count` is more. The first is no shift; where the multiple is even, the first four fall on a grid of
/// 2x2 in all four ways.
[[nodiscard]] std::vector<GridShift> grid_shifts(size_t count, size_t size_multiple);

/// Images extended at the top and on the left by repeating their first rows and columns; they must not be empty. What a
/// lens array gave cannot be extended by less than a lens: it allows no shift.
[[nodiscard]] capture::Measurement extend(const capture::Measurement& measurement, const GridShift& shift);

}  // namespace e2lf::recon
