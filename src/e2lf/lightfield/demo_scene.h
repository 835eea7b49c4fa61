// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {

/// Returns a still life for demonstrations and for tests without data: balls, boxes, books and a test chart on a table
/// in front of a brick wall. Its disparities range from about -2 px (a rod in front) to 1.5 px (the wall), with fine
/// texture everywhere and grey values over the whole range. It suits pictures with an aspect ratio of about 4:3. The
/// seed slightly varies the textures and positions.
[[nodiscard]] Scene demo_scene(uint64_t seed = 1);

/// Returns a still life on a square table in front of a wall. The table and everything on it are rotated by `turn`
/// radians around its middle, so that the motion is known exactly. The balls move on circles and do not spin. The seed
/// varies the textures.
[[nodiscard]] Scene turntable_scene(float turn, uint64_t seed = 1);

}  // namespace e2lf::lightfield
