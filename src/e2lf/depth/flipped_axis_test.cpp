// SPDX-License-Identifier: MIT
#include "e2lf/depth/flipped_axis.h"

#include <gtest/gtest.h>

#include "e2lf/lightfield/demo_scene.h"
#include "e2lf/lightfield/orient.h"
#include "e2lf/lightfield/scene.h"

namespace e2lf::depth {
namespace {

FlippedAxis axis_of(const lightfield::LightField& light_field) {
  return find_flipped_axis(light_field, estimate_disparity(light_field).value()).value();
}

TEST(FlippedAxis, IsFoundInTheDemoScene) {
  const auto light_field = lightfield::render_light_field(lightfield::demo_scene(3), {8, 8, 144, 192, 1});
  EXPECT_EQ(axis_of(light_field), FlippedAxis::kNone);
  auto turned = light_field, flipped_x = light_field, flipped_y = light_field;
  lightfield::orient(turned, capture::kTurned);
  EXPECT_EQ(axis_of(turned), FlippedAxis::kNone);
  lightfield::orient(flipped_x, {.flip_x = true});
  const FlippedAxis x = axis_of(flipped_x);
  EXPECT_TRUE(x == FlippedAxis::kX || x == FlippedAxis::kEither) << static_cast<int>(x);
  lightfield::orient(flipped_y, {.flip_y = true});
  const FlippedAxis y = axis_of(flipped_y);
  EXPECT_TRUE(y == FlippedAxis::kY || y == FlippedAxis::kEither) << static_cast<int>(y);
}

TEST(FlippedAxis, IsNotFoundInNoiseOrInASingleRow) {
  lightfield::LightField noise({4, 4, 64, 64, 1});
  uint32_t state = 1;
  for (float& value : noise.data()) {
    state = state * 1664525U + 1013904223U;
    value = static_cast<float>(state >> 8) / 16777216.0F;
  }
  EXPECT_EQ(axis_of(noise), FlippedAxis::kNone);
  EXPECT_EQ(axis_of(lightfield::LightField({1, 4, 64, 64, 1})), FlippedAxis::kNone);
}

}  // namespace
}  // namespace e2lf::depth
