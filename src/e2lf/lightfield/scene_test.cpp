// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/scene.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/base/threads.h"
#include "testing/textured_plane.h"

namespace e2lf::lightfield {
namespace {

constexpr TextureKind kEveryTexture[] = {TextureKind::kPlain,   TextureKind::kNoise,  TextureKind::kChecks,
                                         TextureKind::kStripes, TextureKind::kBricks, TextureKind::kWood,
                                         TextureKind::kDots,    TextureKind::kMarks,  TextureKind::kStar};

/// Grey of the same value everywhere, under light from everywhere only: a surface that faces the camera shows `value`.
Material flat(float value) {
  Material material{TextureKind::kPlain, value, value};
  material.grain = 0;
  return material;
}

ProceduralScene evenly_lit_scene() {
  ProceduralScene scene;
  scene.light = {.direction = {0, 0, -1}, .intensity = 0, .ambient = 1 / 0.75F, .softness = 0};
  return scene;
}

/// A square that faces the camera, `half` to each side of (x, 0).
Quad facing_square(float x, float z, float half, const Material& material) {
  return {{x - half, -half, z}, {2 * half, 0, 0}, {0, 2 * half, 0}, material};
}

TEST(SceneCamera, TurnsDepthIntoDisparityAndBack) {
  const SceneCamera camera;
  EXPECT_EQ(disparity_at_depth(camera, camera.focus_depth), 0);
  EXPECT_LT(disparity_at_depth(camera, 0.8F), 0);
  for (float disparity : {-2.0F, 0.0F, 1.5F}) {
    EXPECT_NEAR(disparity_at_depth(camera, depth_at_disparity(camera, disparity)), disparity, 1e-5);
  }
  EXPECT_THROW((void)depth_at_disparity(camera, camera.disparity_at_infinity_px), ContractError);
}

TEST(Scene, MovesAPlaneByItsDisparityInBothAxes) {
  // After `steps` views the plane has moved by a whole number of pixels: copies must be equal.
  struct Case {
    float disparity;
    size_t steps;
    int shift;
  };
  for (const Case& test : {Case{1, 1, 1}, Case{-2, 1, -2}, Case{0.5F, 2, 1}, Case{-0.75F, 4, -3}, Case{0, 3, 0}}) {
    const LightField views = render_light_field(textured_plane_scene(test.disparity, 3), {5, 5, 24, 32, 1});
    for (size_t y = 4; y < 20; ++y) {
      for (size_t x = 4; x < 28; ++x) {
        const float here = views.at(0, 0, y, x);
        ASSERT_NEAR(views.at(0, test.steps, y, x + test.shift), here, 5e-4) << test.disparity;
        ASSERT_NEAR(views.at(test.steps, 0, y + test.shift, x), here, 5e-4) << test.disparity;
      }
    }
  }
}

TEST(Scene, FillsPlanesWithContrast) {
  const Image view = render_view(textured_plane_scene(1), {64, 64});
  const auto [low, high] = std::minmax_element(view.pixels.begin(), view.pixels.end());
  EXPECT_LT(*low, 0.2F);
  EXPECT_GT(*high, 0.8F);
}

TEST(Scene, NearSurfacesHideFarOnes) {
  ProceduralScene scene = evenly_lit_scene();
  scene.quads = {facing_square(0, 0.8F, 0.1F, flat(0.9F)), facing_square(0, 1.5F, 3, flat(0.2F))};
  std::swap(scene.quads[0], scene.quads[1]);
  const ViewRequest request{48, 64};
  const Image view = render_view(scene, request), disparity = render_disparity(scene, request);
  const size_t middle = 24 * 64 + 32, corner = 0;
  EXPECT_NEAR(view.pixels[middle], 0.9F, 1e-5);
  EXPECT_NEAR(view.pixels[corner], 0.2F, 1e-5);
  EXPECT_NEAR(disparity.pixels[middle], disparity_at_depth(scene.camera, 0.8F), 1e-5);
  EXPECT_NEAR(disparity.pixels[corner], disparity_at_depth(scene.camera, 1.5F), 1e-5);
}

TEST(Scene, MovesAnEdgeByTheDisparityOfTheNearerSurface) {
  ProceduralScene scene = evenly_lit_scene();
  const float z = depth_at_disparity(scene.camera, -2);
  scene.quads = {facing_square(0.5F * z, z, 0.5F * z, flat(1)), facing_square(0, 1.5F, 3, flat(0))};
  // The near square covers the right half of the middle view: its edge is at x = 32.
  const LightField views = render_light_field(scene, {1, 3, 8, 64, 1});
  for (size_t view_x = 0; view_x < 3; ++view_x) {
    const auto edge = static_cast<size_t>(32 - 2 * (static_cast<int>(view_x) - 1));
    EXPECT_NEAR(views.at(0, view_x, 4, edge - 1), 0, 1e-5) << view_x;
    EXPECT_NEAR(views.at(0, view_x, 4, edge), 1, 1e-5) << view_x;
  }
}

TEST(Scene, AntiAliasesEdges) {
  ProceduralScene scene = evenly_lit_scene();
  // A quarter of a pixel of the square lies in pixel 32 of a 64 px wide view.
  const float pixel = scene.camera.field_width / 64;
  scene.quads = {facing_square(-0.3F + 0.25F * pixel, 1, 0.3F, flat(1))};
  EXPECT_NEAR(render_view(scene, {8, 64, 0, 0, 16}).pixels[4 * 64 + 32], 0.25F, 0.01);
}

TEST(Scene, PutsSpheresAndBlocksWhereTheyAre) {
  ProceduralScene scene = evenly_lit_scene();
  scene.spheres = {{{-0.15F, 0, 1.1F}, 0.1F, flat(0.7F)}};
  scene.blocks = {{{0.15F, 0, 1.2F}, {0.05F, 0.05F, 0.1F}, 0, flat(0.4F)}};
  const Image disparity = render_disparity(scene, {65, 81});
  const Image view = render_view(scene, {65, 81});
  // Where the lines from the pinhole through the middles of both meet the picture.
  const auto column = [&](float x, float z) { return static_cast<size_t>(40.5F + x / z / 0.8F * 81); };
  const size_t sphere = 32 * 81 + column(-0.15F, 1.1F), block = 32 * 81 + column(0.15F, 1.1F);
  EXPECT_NEAR(disparity.pixels[sphere], disparity_at_depth(scene.camera, 1.0F), 0.02);
  EXPECT_NEAR(disparity.pixels[block], disparity_at_depth(scene.camera, 1.1F), 1e-4);
  EXPECT_NEAR(view.pixels[sphere], 0.7F, 0.01);
  EXPECT_NEAR(view.pixels[block], 0.4F, 1e-4);
  EXPECT_EQ(view.pixels[0], 0.0F);
  EXPECT_EQ(disparity.pixels[0], scene.camera.disparity_at_infinity_px);
}

TEST(Scene, TurnsBlocksByTheirYaw) {
  ProceduralScene scene = evenly_lit_scene();
  scene.blocks = {{{0, 0, 1.2F}, {0.1F, 0.1F, 0.1F}, 0.25F * 3.14159265F, flat(1)}};
  // Turned by 45 degrees an edge points at the camera.
  const float nearest = 1.2F - 0.1F * std::sqrt(2.0F);
  const Image disparity = render_disparity(scene, {33, 65});
  EXPECT_NEAR(disparity.pixels[16 * 65 + 32], disparity_at_depth(scene.camera, nearest), 1e-3);
}

TEST(Scene, CastsShadows) {
  ProceduralScene scene;
  scene.light = {.direction = {0, 0, -1}, .intensity = 1, .ambient = 0.4F, .softness = 0.001F};
  scene.quads = {facing_square(0, 1.5F, 3, flat(0.5F))};
  // Light from the camera's direction is blocked where the square stands between lamp and wall; seen from the side.
  scene.light.direction = {-1, 0, -1};
  scene.quads.push_back(facing_square(-0.25F, 1.25F, 0.05F, flat(0.5F)));
  const Image view = render_view(scene, {64, 64});
  EXPECT_NEAR(view.pixels[32 * 64 + 32], 0.5F * 0.4F * 0.75F, 1e-4);
  EXPECT_NEAR(view.pixels[2 * 64 + 60], 0.5F * (0.4F * 0.75F + std::sqrt(0.5F)), 1e-3);
}

TEST(Scene, EveryTextureStaysWithinItsAlbedo) {
  for (TextureKind texture : kEveryTexture) {
    ProceduralScene scene = evenly_lit_scene();
    scene.camera.field_width = 0.2F;
    scene.quads = {facing_square(0, 1, 1, {texture, 0.3F, 0.6F, 0.1F})};
    const Image view = render_view(scene, {48, 64});
    const auto [low, high] = std::minmax_element(view.pixels.begin(), view.pixels.end());
    EXPECT_GE(*low, 0.3F - 1e-4F);
    EXPECT_LE(*high, 0.6F + 1e-4F);
    EXPECT_GT(*high - *low, 0.02F) << static_cast<int>(texture);
  }
}

TEST(DemoScene, HasTheDisparitiesAndBrightnessItPromises) {
  for (uint64_t seed : {0, 1, 7}) {
    const ProceduralScene scene = demo_scene(seed);
    Image disparity = render_disparity(scene, {96, 128}), view = render_view(scene, {96, 128});
    std::sort(disparity.pixels.begin(), disparity.pixels.end());
    std::sort(view.pixels.begin(), view.pixels.end());
    EXPECT_GE(disparity.pixels.front(), -2.2F);
    EXPECT_LE(disparity.pixels.back(), 2.0F);
    EXPECT_LT(disparity.pixels.front(), -1.5F);
    EXPECT_GT(disparity.pixels.back(), 1.2F);
    EXPECT_LT(view.pixels[view.pixels.size() / 50], 0.1F);
    EXPECT_GT(view.pixels[view.pixels.size() * 49 / 50], 0.85F);
  }
}

TEST(DemoScene, GroundTruthDisparityExplainsTheNextView) {
  const ProceduralScene scene = demo_scene(2);
  const Image here = render_view(scene, {96, 128}), next = render_view(scene, {96, 128, 0, 1});
  const Image disparity = render_disparity(scene, {96, 128});
  double with_truth = 0, without = 0;
  for (size_t y = 0; y < 96; ++y) {
    for (size_t x = 4; x < 124; ++x) {
      const size_t i = y * 128 + x;
      const float target = static_cast<float>(x) + disparity.pixels[i];
      const float* left = &next.pixels[y * 128 + static_cast<size_t>(target)];
      const float t = target - std::floor(target);
      with_truth += std::abs((1 - t) * left[0] + t * left[1] - here.pixels[i]);
      without += std::abs(next.pixels[i] - here.pixels[i]);
    }
  }
  EXPECT_LT(with_truth, 0.4 * without);
}

TEST(DemoScene, DependsOnTheSeedAlone) {
  const Shape shape{2, 2, 48, 64, 1};
  set_num_threads(1);
  const LightField one = render_light_field(demo_scene(4), shape);
  set_num_threads(3);
  const LightField three = render_light_field(demo_scene(4), shape);
  set_num_threads(0);
  EXPECT_TRUE(std::equal(one.data().begin(), one.data().end(), three.data().begin()));
  const LightField other = render_light_field(demo_scene(5), shape);
  EXPECT_FALSE(std::equal(one.data().begin(), one.data().end(), other.data().begin()));
}

}  // namespace
}  // namespace e2lf::lightfield
