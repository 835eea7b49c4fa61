// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {

/// A position on a surface, in units of the scene. On quads and blocks, it is measured from the middle of a face.
struct SurfacePoint {
  float u = 0, v = 0;
  float footprint = 0;  ///< width of a pixel there: finer detail is faded out, and edges have this width
};

/// Returns the albedo, in [0, 1], of a material at a position: dark + (bright - dark) * texture.
[[nodiscard]] float albedo(const Material& material, const SurfacePoint& point);

}  // namespace e2lf::lightfield
