// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "e2lf/lightfield/scene.h"

namespace e2lf::lightfield {
namespace {

TEST(TurntableScene, TurnsTheTableAndAllThatStandsOnItAlike) {
  constexpr float kTurn = 0.4F;
  const ProceduralScene before = turntable_scene(0), after = turntable_scene(kTurn);
  const Quad &table = before.quads.back(), &turned = after.quads.back();
  EXPECT_NEAR(std::atan2(turned.edge_u.z, turned.edge_u.x) - std::atan2(table.edge_u.z, table.edge_u.x), kTurn, 1e-5);
  const Vec3 middle = {table.corner.x + 0.5F * (table.edge_u.x + table.edge_v.x), 0,
                       table.corner.z + 0.5F * (table.edge_u.z + table.edge_v.z)};
  const auto expect_turned = [&](const Vec3& from, const Vec3& to) {
    const double angle = std::atan2(to.z - middle.z, to.x) - std::atan2(from.z - middle.z, from.x);
    EXPECT_NEAR(std::remainder(angle, 2 * std::numbers::pi), kTurn, 1e-4);
    EXPECT_NEAR(std::hypot(to.z - middle.z, to.x), std::hypot(from.z - middle.z, from.x), 1e-5);
    EXPECT_EQ(from.y, to.y);
  };
  expect_turned(table.corner, turned.corner);
  for (size_t i = 0; i < before.blocks.size(); ++i) {
    expect_turned(before.blocks[i].centre, after.blocks[i].centre);
    EXPECT_NEAR(after.blocks[i].yaw - before.blocks[i].yaw, kTurn, 1e-6);
  }
  for (size_t i = 0; i < before.spheres.size(); ++i) expect_turned(before.spheres[i].centre, after.spheres[i].centre);
}

TEST(TurntableScene, MovesWhatStandsOnTheTableAndNothingElse) {
  constexpr size_t kHeight = 48, kWidth = 64;
  const Image still = render_view(turntable_scene(0.0F), {.height = kHeight, .width = kWidth});
  const Image turned = render_view(turntable_scene(0.2F), {.height = kHeight, .width = kWidth});
  size_t moved = 0, moved_at_the_top = 0;
  for (size_t i = 0; i < kHeight * kWidth; ++i) {
    const bool differs = std::abs(still.pixels[i] - turned.pixels[i]) > 0.02F;
    moved += differs ? 1 : 0;
    moved_at_the_top += differs && i < 4 * kWidth ? 1 : 0;
  }
  EXPECT_GT(moved, kHeight * kWidth / 20);
  EXPECT_EQ(moved_at_the_top, 0U);
}

}  // namespace
}  // namespace e2lf::lightfield
