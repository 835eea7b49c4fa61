// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::recon {

/// The position of the upper left pixel of an image on the grid of a network.
struct GridShift {
  size_t y = 0, x = 0;
  bool operator==(const GridShift&) const = default;
};

/// Returns the first `count` distinct shifts on the grid of a network with `size_multiple`, or all size_multiple^2 of
/// them if `count` is larger. The first one is zero. If the multiple is even, the first four cover all four positions
/// on a 2x2 grid.
[[nodiscard]] std::vector<GridShift> grid_shifts(size_t count, size_t size_multiple);

/// Extends images at the top and on the left by repeating their first rows and columns. The images must not be empty.
/// The image behind a lens array can only be extended by whole lenses and therefore allows no shift.
[[nodiscard]] capture::Measurement extend(const capture::Measurement& measurement, const GridShift& shift);

}  // namespace e2lf::recon
