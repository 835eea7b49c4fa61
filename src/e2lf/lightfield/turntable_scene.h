// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {

/// Returns a still life on a square table in front of a wall. The table and everything on it are rotated by `turn`
/// radians around its middle, so that the motion is known exactly. The balls move on circles and do not spin. The seed
/// varies the textures.
[[nodiscard]] Scene turntable_scene(float turn, uint64_t seed = 0);

}  // namespace e2lf::lightfield
