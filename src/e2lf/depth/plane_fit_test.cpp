// SPDX-License-Identifier: MIT
#include "e2lf/depth/plane_fit.h"

#include <gtest/gtest.h>

namespace e2lf::depth {
namespace {

using lightfield::Image;

TEST(PlaneFit, FindsAPlaneFromMeasurementsOnIt) {
  Measurements measurements{Image(40, 30, 1), Image(40, 30, 1), 0.01F};
  for (size_t i = 0; i < 1200; ++i) {
    measurements.value.pixels[i] = 0.5F + 0.01F * static_cast<float>(i % 40) - 0.02F * static_cast<float>(i / 40);
    measurements.weight.pixels[i] = 1;
  }
  Planes planes = flat_planes(measurements.value);
  for (int turn = 0; turn < 8; ++turn) fit_planes(measurements, Image(40, 30, 1), {}, planes);
  const size_t middle = 15 * 40 + 20;
  EXPECT_NEAR(planes.value.pixels[middle], measurements.value.pixels[middle], 1e-4);
  EXPECT_NEAR(planes.slope_x.pixels[middle], 0.01F, 1e-3);
  EXPECT_NEAR(planes.slope_y.pixels[middle], -0.02F, 2e-3);
  EXPECT_GT(planes.agreement.pixels[middle], 0.99F);
}

TEST(PlaneFit, KeepsASteep) {
  // A step of 1 px between columns 19 and 20, with noise of 0.02 px.
  Measurements measurements{Image(40, 30, 1), Image(40, 30, 1), 0.01F};
  for (size_t i = 0; i < 1200; ++i) {
    const float noise = (i * 7919) % 5 < 2 ? 0.03F : -0.02F;
    measurements.value.pixels[i] = (i % 40 < 20 ? 0.0F : 1.0F) + noise;
    measurements.weight.pixels[i] = 1;
  }
  Planes planes = flat_planes(measurements.value);
  for (int turn = 0; turn < 3; ++turn) fit_planes(measurements, Image(40, 30, 1), {}, planes);
  for (size_t x = 8; x < 32; ++x) EXPECT_NEAR(planes.value.pixels[15 * 40 + x], x < 20 ? 0 : 1, 0.015F) << x;
}

TEST(SemiGlobal, TakesTheBestPathInARow) {
  // Three pixels in a row, of which the middle one has no confidence: it takes the disparity of its neighbours.
  CostVolume volume{1, 3, {0, 1, 3}, {900, 0, 900, 500, 500, 500, 900, 0, 900}};
  smooth_costs(volume, Image(3, 1, 1));
  const int16_t* const middle = volume.at(0, 1);
  EXPECT_LT(middle[1], middle[0]);
  // Six of eight directions begin anew here (500 each); of the other two each path ends in 500 + what it cost to
  // come from label 1: nothing, or a step of 64.
  EXPECT_EQ(middle[1], 8 * 500);
  EXPECT_EQ(middle[0], 8 * 500 + 2 * 64);
}

}  // namespace
}  // namespace e2lf::depth
