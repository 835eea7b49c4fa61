// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/video/video_model.h"

namespace e2lf::video {
namespace {

TEST(NormaliseNonzero, LeavesZerosAndGivesTheRestMeanZeroAndDeviationOne) {
  std::vector<float> voxels = {0.0F, 1.0F, 0.0F, 3.0F, 5.0F, 0.0F, 7.0F};
  normalise_nonzero(voxels);
  // Mean 4, deviation sqrt(5).
  const float unit = 1.0F / std::sqrt(5.0F);
  EXPECT_EQ(voxels[0], 0.0F);
  EXPECT_EQ(voxels[5], 0.0F);
  EXPECT_NEAR(voxels[1], -3 * unit, 1e-6);
  EXPECT_NEAR(voxels[3], -1 * unit, 1e-6);
  EXPECT_NEAR(voxels[4], 1 * unit, 1e-6);
  EXPECT_NEAR(voxels[6], 3 * unit, 1e-6);
}

TEST(NormaliseNonzero, VoxelsOfOneValueBecomeZero) {
  std::vector<float> voxels = {0.0F, 2.0F, 2.0F};
  normalise_nonzero(voxels);
  EXPECT_EQ(voxels, (std::vector<float>{0.0F, 0.0F, 0.0F}));
}

TEST(NormaliseNonzero, AnEmptyGridStaysEmpty) {
  std::vector<float> voxels(4);
  normalise_nonzero(voxels);
  EXPECT_EQ(voxels, std::vector<float>(4));
}

}  // namespace
}  // namespace e2lf::video
