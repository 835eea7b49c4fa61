// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {

/// A still life for demonstrations and tests without data: balls, boxes, books and a test chart on a table before a
/// brick wall, at disparities of about -2 (a rod in front) to 1.5 px (wall), with fine texture everywhere
/// and grey values over the whole range. Meant for pictures of about 4:3. The seed varies textures and places a little.
[[nodiscard]] Scene demo_scene(uint64_t seed = 0);

/// A single plane that faces the camera at this disparity (px per view step) and fills every view, lit evenly, with a
/// noise texture of high contrast: detail from a quarter of the picture down to two or three pixels, whatever the size
/// (16 px wide or more). All views are shifted copies of each other. Disparities of 4 and more break the contract.
[[nodiscard]] Scene textured_plane_scene(float disparity_px, uint64_t seed = 0);

}  // namespace e2lf::lightfield
