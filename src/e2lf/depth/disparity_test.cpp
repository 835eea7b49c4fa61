// SPDX-License-Identifier: MIT
#include "e2lf/depth/disparity.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/base/rng.h"
#include "e2lf/base/threads.h"
#include "e2lf/lightfield/scene.h"
#include "testing/noise_material.h"
#include "testing/textured_plane.h"

namespace e2lf::depth {
namespace {

using lightfield::Image;
using lightfield::LightField;
using lightfield::ProceduralScene;
using lightfield::Shape;

/// The disparities that view (4, 4) of 8x8 sees.
Image truth_of(const ProceduralScene& scene, const Shape& shape) {
  return lightfield::render_disparity(scene, {shape.height, shape.width, 0.5F, 0.5F});
}

/// The share of pixels, `margin` px from the borders, whose error is more than `most_px`.
double bad_pixels(const Image& disparity, const Image& truth, float most_px, size_t margin) {
  double bad = 0, count = 0;
  for (size_t y = margin; y + margin < truth.height; ++y) {
    for (size_t x = margin; x + margin < truth.width; ++x, ++count) {
      const size_t i = y * truth.width + x;
      bad += std::abs(disparity.pixels[i] - truth.pixels[i]) > most_px ? 1 : 0;
    }
  }
  return bad / count;
}

/// A wall that turns away to the right, and a square that stands before it.
ProceduralScene slanted_wall_and_square() {
  ProceduralScene scene = lightfield::textured_plane_scene(0);
  scene.quads = {{{-3, -3, 0.8F}, {6, 0, 0.8F}, {0, 6, 0}, noise_material(1)}};
  const float z = lightfield::depth_at_disparity(scene.camera, -1.6F);
  scene.quads.push_back({{-0.1F, -0.1F, z}, {0.2F, 0, 0}, {0, 0.2F, 0}, noise_material(2)});
  return scene;
}

TEST(Disparity, OfAPlaneIsExactToTwoHundredths) {
  for (float disparity : {-2.3F, -0.5F, 0.0F, 0.13F, 1.7F}) {
    const Shape shape{8, 8, 64, 80, 1};
    const ProceduralScene scene = lightfield::textured_plane_scene(disparity);
    const auto map = estimate_disparity(lightfield::render_light_field(scene, shape));
    ASSERT_TRUE(map.ok());
    EXPECT_EQ(map->view, (ViewIndex{4, 4}));
    EXPECT_LE(map->range.least, disparity);
    EXPECT_GE(map->range.most, disparity);
    EXPECT_LT(bad_pixels(map->disparity, truth_of(scene, shape), 0.02F, 10), 0.01) << disparity;
  }
}

TEST(Disparity, OfASlantedPlaneBehindASquareHasSharpEdges) {
  const Shape shape{8, 8, 128, 160, 1};
  const ProceduralScene scene = slanted_wall_and_square();
  const LightField light_field = lightfield::render_light_field(scene, shape);
  const auto map = estimate_disparity(light_field);
  ASSERT_TRUE(map.ok());
  const Image truth = truth_of(scene, shape);
  EXPECT_LT(bad_pixels(map->disparity, truth, 0.07F, 10), 0.035);
  EXPECT_LT(bad_pixels(map->disparity, truth, 0.03F, 10), 0.05);
  // An edge moved by a pixel all around the square would be 1.6 % of the pixels.
  EXPECT_LT(bad_pixels(map->disparity, truth, 0.5F, 10), 0.016);
}

TEST(Disparity, FillsWhatHasNoTextureFromItsSurroundings) {
  const Shape shape{8, 8, 64, 80, 1};
  const ProceduralScene scene = lightfield::textured_plane_scene(0.8F);
  LightField light_field = lightfield::render_light_field(scene, shape);
  // A grey patch that moves as the plane does: 20x20 px of nothing.
  for (size_t view_y = 0; view_y < 8; ++view_y) {
    for (size_t view_x = 0; view_x < 8; ++view_x) {
      const auto at = [](size_t middle, size_t view) {
        return static_cast<size_t>(std::lround(static_cast<float>(middle) + 0.8F * (static_cast<float>(view) - 4)));
      };
      for (size_t y = 0; y < 20; ++y) {
        for (size_t x = 0; x < 20; ++x) light_field.at(view_y, view_x, at(22, view_y) + y, at(30, view_x) + x) = 0.5F;
      }
    }
  }
  const auto map = estimate_disparity(light_field);
  ASSERT_TRUE(map.ok());
  for (size_t y = 28; y < 36; ++y) {
    for (size_t x = 36; x < 44; ++x) {
      EXPECT_NEAR(map->disparity.pixels[y * 80 + x], 0.8F, 0.1F) << y << ' ' << x;
      EXPECT_LT(map->confidence.pixels[y * 80 + x], map->confidence.pixels[10 * 80 + 14]);
    }
  }
}

TEST(Disparity, OfTheDemoSceneIsGoodAndItsConfidenceTellsWhere) {
  const Shape shape{8, 8, 144, 192, 1};
  const ProceduralScene scene = lightfield::demo_scene(3);
  const auto map = estimate_disparity(lightfield::render_light_field(scene, shape));
  ASSERT_TRUE(map.ok());
  const Image truth = truth_of(scene, shape);
  EXPECT_LT(bad_pixels(map->disparity, truth, 0.07F, 8), 0.12);
  double bad[2] = {}, count[2] = {};
  for (size_t i = 0; i < truth.pixels.size(); ++i) {
    const size_t is_sure = map->confidence.pixels[i] > 0.7F ? 1 : 0;
    count[is_sure] += 1;
    bad[is_sure] += std::abs(map->disparity.pixels[i] - truth.pixels[i]) > 0.07F ? 1 : 0;
  }
  EXPECT_GT(count[1], 0.3 * static_cast<double>(truth.pixels.size()));
  EXPECT_LT(bad[1] / count[1], 0.3 * bad[0] / count[0]);
}

TEST(Disparity, FindsItsRangeWhereItIsSure) {
  const Shape shape{8, 8, 96, 80, 1};
  LightField light_field = lightfield::render_light_field(lightfield::textured_plane_scene(0.8F), shape);
  // Most of each view is dark, with faint blotches that no other view has: some disparity fits a little everywhere.
  const CounterRng rng(5, 0);
  for (size_t view = 0; view < 64; ++view) {
    for (size_t y = 36; y < 96; ++y) {
      for (size_t x = 0; x < 80; ++x) {
        const float blotch = rng.uniform((view * 24 + y / 4) * 20 + x / 4);
        light_field.at(view / 8, view % 8, y, x) = 0.02F + 0.06F * blotch;
      }
    }
  }
  const auto map = estimate_disparity(light_field);
  ASSERT_TRUE(map.ok());
  // The border of the dark area is at the same place in all views, a disparity of 0.
  EXPECT_GT(map->range.least, -0.5F);
  EXPECT_LT(map->range.most, 1.3F);
}

TEST(Disparity, WorksOnARowOfViewsAndInColour) {
  const ProceduralScene scene = lightfield::textured_plane_scene(1.2F);
  const Shape row{1, 7, 40, 64, 1};
  const LightField grey = lightfield::render_light_field(scene, row);
  LightField colour({1, 7, 40, 64, 3});
  for (size_t i = 0; i < colour.data().size(); ++i) colour.data()[i] = grey.data()[i / 3];
  const DisparityOptions options{.view = ViewIndex{0, 3}, .range = DisparityRange{0, 2}};
  const auto of_grey = estimate_disparity(grey, options), of_colour = estimate_disparity(colour, options);
  ASSERT_TRUE(of_grey.ok() && of_colour.ok());
  EXPECT_EQ(of_grey->disparity, of_colour->disparity);
  for (size_t x = 10; x < 54; ++x) EXPECT_NEAR(of_grey->disparity.pixels[20 * 64 + x], 1.2F, 0.03F);
}

TEST(Disparity, DoesNotDependOnTheNumberOfThreads) {
  const LightField light_field = lightfield::render_light_field(lightfield::demo_scene(4), {8, 8, 50, 70, 1});
  set_num_threads(1);
  const auto one = estimate_disparity(light_field);
  set_num_threads(3);
  const auto three = estimate_disparity(light_field);
  set_num_threads(0);
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(one->disparity, three->disparity);
  EXPECT_EQ(one->confidence, three->confidence);
}

TEST(Disparity, IsFiniteWhateverTheViewsHold) {
  for (const Shape& shape : {Shape{2, 2, 1, 1, 1}, Shape{1, 2, 3, 2, 1}, Shape{3, 1, 2, 40, 1}, Shape{8, 8, 5, 4, 1}}) {
    LightField light_field(shape);  // black
    for (int turn = 0; turn < 2; ++turn) {
      const auto map = estimate_disparity(light_field);
      ASSERT_TRUE(map.ok());
      for (float value : map->disparity.pixels) EXPECT_TRUE(std::isfinite(value));
      for (float value : map->confidence.pixels) EXPECT_TRUE(value >= 0 && value <= 1);
      const CounterRng rng(7, 0);
      for (size_t i = 0; i < shape.size(); ++i) light_field.data()[i] = rng.uniform(i);
    }
  }
}

TEST(Disparity, RefusesWhatHasNone) {
  EXPECT_EQ(estimate_disparity(LightField({1, 1, 8, 8, 1})).error().code, ErrorCode::kShape);
  const LightField light_field({2, 2, 8, 8, 1});
  EXPECT_EQ(estimate_disparity(light_field, {.view = ViewIndex{2, 0}, .range = {}}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(estimate_disparity(light_field, {.view = {}, .range = DisparityRange{1, 1}}).error().code,
            ErrorCode::kInvalidValue);
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(estimate_disparity(light_field, {.view = {}, .range = DisparityRange{0, infinity}}).error().code,
            ErrorCode::kInvalidValue);
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), -infinity, 1e38F}) {
    LightField damaged({2, 2, 8, 8, 1});
    damaged.data()[3] = value;
    EXPECT_EQ(estimate_disparity(damaged).error().code, ErrorCode::kInvalidValue) << value;
  }
}

}  // namespace
}  // namespace e2lf::depth
