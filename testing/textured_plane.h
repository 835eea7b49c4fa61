// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/rng.h"
#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {

/// Returns the depth of a disparity, the inverse of disparity_at_depth(). Disparities of disparity_at_infinity_px and
/// more break the contract.
inline float depth_at_disparity(const SceneCamera& camera, float disparity_px) {
  E2LF_REQUIRE(disparity_px < camera.disparity_at_infinity_px, "nothing is farther away than infinity");
  return camera.focus_depth / (1 - disparity_px / camera.disparity_at_infinity_px);
}

/// Returns a single evenly lit plane that faces the camera at this disparity (px per view step) and fills every view.
/// Its noise texture has high contrast and detail from a quarter of the picture down to two or three pixels, at any
/// size (16 px wide or more). All views are shifted copies of each other. Disparities of 4 and more break the contract.
inline ProceduralScene textured_plane_scene(float disparity_px, uint64_t seed = 0) {
  ProceduralScene scene;
  const float z = depth_at_disparity(scene.camera, disparity_px);
  Material material{TextureKind::kNoise, 0.0F, 1.0F, 0.2F};
  material.grain = 0;
  material.seed = CounterRng(seed, 1).bits(0)[0];
  // The quad is larger than any view, in units of the field at that depth.
  const float half = 8 * z * scene.camera.field_width;
  scene.quads.push_back({{-half, -half, z}, {2 * half, 0, 0}, {0, 2 * half, 0}, material});
  scene.light.direction = {0, 0, -1};
  scene.light.intensity = 0;
  scene.light.ambient = 1 / 0.75F;
  return scene;
}

}  // namespace e2lf::lightfield
