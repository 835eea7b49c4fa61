// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {

/// A still life on a square table before a wall, the table with all that stands on it turned by `turn` radians around
/// its middle: a scene whose motion is known exactly. Balls move on their circle and do not spin. The seed varies
/// textures.
[[nodiscard]] Scene turntable_scene(float turn, uint64_t seed = 0);

}  // namespace e2lf::lightfield
