// SPDX-License-Identifier: MIT
#include "e2lf/depth/view_order.h"

#include <gtest/gtest.h>

#include "e2lf/lightfield/scene.h"
#include "e2lf/lightfield/views.h"
#include "testing/noise_material.h"
#include "testing/textured_plane.h"

namespace e2lf::depth {
namespace {

using lightfield::LightField;
using lightfield::ProceduralScene;
using Verdict = OcclusionSign::Verdict;

OcclusionSign sign_of(const LightField& light_field) {
  return occlusion_sign(light_field, estimate_disparity(light_field).value());
}

/// A square of disparity -1.6 before a wall of 0.8: both have texture.
LightField square_before_wall() {
  ProceduralScene scene = lightfield::textured_plane_scene(0.8F);
  const float z = lightfield::depth_at_disparity(scene.camera, -1.6F);
  scene.quads.push_back({{-0.12F, -0.12F, z}, {0.24F, 0, 0}, {0, 0.24F, 0}, noise_material(2)});
  return lightfield::render_light_field(scene, {8, 8, 128, 160, 1});
}

TEST(OcclusionSign, TellsASquareBeforeAWallFromAHoleInIt) {
  LightField light_field = square_before_wall();
  const OcclusionSign upright = sign_of(light_field);
  EXPECT_EQ(upright.verdict, Verdict::kUpright) << upright.places << ' ' << upright.deviations;
  EXPECT_GT(upright.confidence(), 0.8F);
  lightfield::orient(light_field, capture::kTurned);
  const OcclusionSign turned = sign_of(light_field);
  EXPECT_EQ(turned.verdict, Verdict::kTurned) << turned.places << ' ' << turned.deviations;
  EXPECT_GT(turned.confidence(), 0.8F);
}

TEST(OcclusionSign, IsRightAboutTheDemoScene) {
  LightField light_field = lightfield::render_light_field(lightfield::demo_scene(3), {8, 8, 144, 192, 1});
  EXPECT_EQ(sign_of(light_field).verdict, Verdict::kUpright);
  lightfield::orient(light_field, capture::kTurned);
  EXPECT_EQ(sign_of(light_field).verdict, Verdict::kTurned);
}

TEST(OcclusionSign, LeavesOpenWhereNothingHidesAnything) {
  const auto plane = lightfield::textured_plane_scene(0.8F);
  EXPECT_EQ(sign_of(lightfield::render_light_field(plane, {8, 8, 64, 80, 1})).verdict, Verdict::kUndecided);
  EXPECT_EQ(sign_of(LightField({8, 8, 20, 20, 1})).verdict, Verdict::kUndecided);
  EXPECT_EQ(sign_of(LightField({1, 2, 20, 20, 1})).places, 0U);
}

}  // namespace
}  // namespace e2lf::depth
