// SPDX-License-Identifier: MIT
#include "e2lf/film/parallax.h"

#include <gtest/gtest.h>

#include "e2lf/lightfield/scene.h"
#include "testing/textured_plane.h"

namespace e2lf::film {
namespace {

using lightfield::Image;
using lightfield::LightField;

TEST(Orbit, TouchesTheRimOfTheViewsAndStaysWithin) {
  const std::vector<Viewpoint> path = orbit({8, 5, 1, 1, 1}, 12);
  ASSERT_EQ(path.size(), 12U);
  EXPECT_NEAR(path[0].y, 0, 1e-5);  // top
  EXPECT_NEAR(path[0].x, 2, 1e-5);
  EXPECT_NEAR(path[3].y, 3.5, 1e-5);  // right
  EXPECT_NEAR(path[3].x, 4, 1e-5);
  EXPECT_NEAR(path[6].y, 7, 1e-5);
}

TEST(Sweep, GoesToTheRightAndBack) {
  const std::vector<Viewpoint> path = sweep({8, 8, 1, 1, 1}, 8);
  EXPECT_NEAR(path[0].x, 0, 1e-5);
  EXPECT_NEAR(path[4].x, 7, 1e-5);
  EXPECT_NEAR(path[2].x, path[6].x, 1e-5);
  EXPECT_EQ(path[1].y, 3.5F);
  EXPECT_NEAR(focus_sweep(-1, 2, 8)[4], 2, 1e-5);
  EXPECT_EQ(focus_sweep(-1, 2, 8)[0], -1);
}

TEST(PictureFrom, IsAViewWhereThatIsAndAPlaneStandsStillBetween) {
  const auto scene = lightfield::textured_plane_scene(1);
  const LightField light_field = lightfield::render_light_field(scene, {4, 4, 40, 48, 1});
  const Image view = picture_from(light_field, {1, 2}, 0);
  for (size_t i = 0; i < view.pixels.size(); ++i) ASSERT_NEAR(view.pixels[i], light_field.view(1, 2)[i], 1e-6);
  const Image middle = lightfield::render_view(scene, {40, 48});
  for (const Viewpoint& viewpoint : {Viewpoint{0, 0}, Viewpoint{1.3F, 2.8F}, Viewpoint{3, 3}}) {
    const Image picture = picture_from(light_field, viewpoint, 1);
    double error = 0;
    for (size_t y = 8; y < 32; ++y) {
      for (size_t x = 8; x < 40; ++x) error += std::abs(picture.pixels[y * 48 + x] - middle.pixels[y * 48 + x]);
    }
    EXPECT_LT(error / (24 * 32), 0.02) << viewpoint.x;
  }
  EXPECT_THROW((void)picture_from(light_field, {0, 3.5F}, 0), ContractError);
}

}  // namespace
}  // namespace e2lf::film
