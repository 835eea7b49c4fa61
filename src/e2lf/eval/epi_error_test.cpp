// SPDX-License-Identifier: MIT
#include "e2lf/eval/epi_error.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/lightfield/demo_scene.h"

namespace e2lf::eval {
namespace {

using lightfield::LightField;

/// Every value of view (r, c) is r * step_y + c * step_x.
LightField ramp(float step_y, float step_x) {
  LightField light_field({3, 3, 4, 5, 1});
  for (size_t view = 0; view < 9; ++view) {
    for (float& value : light_field.view(view / 3, view % 3)) {
      value = step_y * static_cast<float>(view / 3) + step_x * static_cast<float>(view % 3);
    }
  }
  return light_field;
}

TEST(EpiError, MeasuresChangesFromViewToView) {
  // Errors of the changes: 0.1 in rows of views, 0.2 in columns, as many of each; the true changes are 0.25 and 0.
  const EpiError error = epi_error(ramp(0, 0.25F), ramp(0.2F, 0.15F), false);
  EXPECT_NEAR(error.rms, std::sqrt((0.01 + 0.04) / 2), 1e-7);
  EXPECT_NEAR(error.relative, std::sqrt((0.01 + 0.04) / 0.0625), 1e-6);
}

TEST(EpiError, IgnoresWhatIsWrongInEveryView) {
  LightField shifted = ramp(0.125F, 0.25F);
  for (float& value : shifted.data()) value += 0.5F;
  EXPECT_EQ(epi_error(ramp(0.125F, 0.25F), shifted, false).rms, 0);
}

TEST(EpiError, IsOneForTheSamePictureInAllViews) {
  const LightField truth = lightfield::render_light_field(lightfield::textured_plane_scene(1), {3, 3, 16, 16, 1});
  LightField same(truth.shape());
  for (size_t view = 0; view < 9; ++view) {
    std::copy(truth.view(1, 1).begin(), truth.view(1, 1).end(), same.view(view / 3, view % 3).begin());
  }
  EXPECT_DOUBLE_EQ(epi_error(truth, same, true).relative, 1);
}

TEST(EpiError, ClampsTheReconstructionWhenAsked) {
  const LightField truth = ramp(0, 0);
  EXPECT_EQ(epi_error(truth, ramp(-1, -1), true).rms, 0);
  EXPECT_EQ(epi_error(truth, ramp(-1, -1), false).rms, 1);
  EXPECT_EQ(epi_error(truth, ramp(-1, -1), false).relative, std::numeric_limits<double>::infinity());
}

TEST(EpiError, IsZeroWithoutNeighbours) {
  LightField one({1, 1, 2, 2, 1}), other({1, 1, 2, 2, 1});
  other.at(0, 0, 0, 0) = 1;
  EXPECT_EQ(epi_error(one, other, true).rms, 0);
}

}  // namespace
}  // namespace e2lf::eval
