// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "e2lf/learn/data/surfaces.h"

namespace e2lf::learn {

/// Border by which maps are extended on every side for the taps of the interpolation, px.
constexpr size_t kMapBorder = 3;

/// A plane and its two maps, interleaved: [side + 2 kMapBorder, side + 2 kMapBorder, 2], brightness and coverage.
struct MappedPlane {
  Plane plane;
  const float* maps = nullptr;
};

/// The viewpoint of a view, in view steps from the centre of the aperture.
struct ViewPoint {
  double y = 0, x = 0;
};

/// Renders one view [size, size] of planes that are ordered back to front. Each pixel is composed front to back until
/// the remaining planes contribute less than a quarter of a grey level of 255. Positions in the maps are rounded to
/// 1/1024 px. Vector kernel, dispatched at run time.
void render_view(std::span<const MappedPlane> planes, size_t side, const ViewPoint& from, size_t size, float* view);

}  // namespace e2lf::learn
