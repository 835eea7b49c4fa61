// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {

/// A place on a surface, in units of the scene. Quads and blocks measure from the middle of a face.
struct SurfacePoint {
  float u = 0, v = 0;
  float footprint = 0;  ///< width of a pixel there: finer detail is faded out, edges are that wide
};

/// The albedo in [0, 1] of a material at a place: dark + (bright - dark) * texture.
[[nodiscard]] float albedo(const Material& material, const SurfacePoint& point);

}  // namespace e2lf::lightfield
