// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "e2lf/learn/data/surfaces.h"

namespace e2lf::learn {

/// px by which maps are continued on every side, for the taps of the interpolation.
constexpr size_t kMapBorder = 3;

/// A plane and its two maps side by side: [side + 2 kMapBorder, side + 2 kMapBorder, 2], brightness and coverage.
struct MappedPlane {
  Plane plane;
  const float* maps = nullptr;
};

/// Where a view looks from, in view steps from the centre of the aperture.
struct ViewPoint {
  double y = 0, x = 0;
};

/// One view [size, size] of planes given back to front, each pixel front to back until nothing behind can be seen (less
/// than a quarter of a grey level of 255). Positions in the maps are rounded to 1/1024 px. Vector kernel, chosen at run
/// time.
void render_view(std::span<const MappedPlane> planes, size_t side, const ViewPoint& from, size_t size, float* view);

}  // namespace e2lf::learn
