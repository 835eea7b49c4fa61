// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/known_scenes.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

namespace e2lf::learn {
namespace {

constexpr int64_t kSize = 40, kSide = 72;

torch::Tensor axis(int64_t length) {
  return torch::arange(length, torch::kFloat) - 0.5 * static_cast<double>(length - 1);
}

/// A wave of less than the steepest slope.
torch::Tensor wave() {
  return (0.4 * torch::sin(axis(kSide) / 6).unsqueeze(0) * torch::cos(axis(kSide) / 9).unsqueeze(1)).contiguous();
}

Surface ramp_with_relief() {
  Surface surface{{.centre = 0.8, .slope_y = 0.005, .slope_x = -0.01}, {}, {}};
  surface.brightness = (0.5 + axis(kSide) / kSide).expand({kSide, kSide}).contiguous();
  surface.relief = wave();
  return surface;
}

/// Where the brightness is the column, a view shows by how much each pixel has moved.
TEST(Reliefs, ViewsShowTheirDisparity) {
  const Surface surface = ramp_with_relief();
  for (const auto& render : {views_of, views_of_reference}) {
    const auto views = render({surface}, kSize);
    for (const int64_t column : {0, 4, 7}) {
      const double from = static_cast<double>(column) - 3.5;
      const auto moved = axis(kSize) - (views[4 * 8 + column] - 0.5) * kSide;
      const auto disparity = disparity_of({surface}, kSize, {0.5, from});
      // The cubic interpolation with a = -0.75 moves a ramp by up to 0.05 px.
      EXPECT_LT((moved - from * disparity).abs().max().item<double>(), 0.06) << column;
    }
  }
}

TEST(Reliefs, AreRenderedAlikeByBothImplementations) {
  torch::manual_seed(1);
  Surface back = ramp_with_relief(), front{{.centre = -1.5, .slope_x = 0.01}, torch::rand({kSide, kSide}), {}};
  front.coverage = (torch::rand({kSide, kSide}) > 0.5).to(torch::kFloat);
  front.relief = -wave();
  const auto difference = views_of({back, front}, kSize) - views_of_reference({back, front}, kSize);
  EXPECT_LT(difference.abs().max().item<double>(), 0.01);  // positions are rounded to 1/1024 px
}

TEST(Reliefs, TheNearestOpaqueSurfaceIsSeen) {
  Surface back{{.centre = 2}, torch::zeros({kSide, kSide}), {}}, front{{.centre = -1}, torch::ones({kSide, kSide}), {}};
  front.coverage = (axis(kSide) > 0).to(torch::kFloat).expand({kSide, kSide}).contiguous();
  const auto disparity = disparity_of({back, front}, kSize, {0, 0});
  EXPECT_TRUE(torch::allclose(disparity.slice(1, 0, kSize / 2), torch::full({1}, 2.0)));
  EXPECT_TRUE(torch::allclose(disparity.slice(1, kSize / 2), torch::full({1}, -1.0)));
}

SynthesiserOptions options() {
  SynthesiserOptions options;
  options.size = kSize;
  options.max_disparity = 3.2;
  return options;
}

TEST(KnownScenes, DependOnTheSeedAlone) {
  torch::manual_seed(1);
  const auto first = synthesise_known({}, options(), 5, torch::kCPU);
  torch::manual_seed(2);
  const auto again = synthesise_known({}, options(), 5, torch::kCPU);
  EXPECT_TRUE(torch::equal(first.views, again.views));
  EXPECT_TRUE(torch::equal(first.disparity, again.disparity));
  EXPECT_FALSE(torch::equal(first.views, synthesise_known({}, options(), 6, torch::kCPU).views));
}

/// Disparities are limited, differ between scenes, and move little between central views, as surfaces do.
TEST(KnownScenes, HaveDisparitiesWithinTheirLimits) {
  double nearest = 0, farthest = 0;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    const KnownScene scene = synthesise_known({}, options(), seed, torch::kCPU);
    ASSERT_EQ(scene.views.sizes(), (at::IntArrayRef{64, kSize, kSize}));
    ASSERT_EQ(scene.disparity.sizes(), (at::IntArrayRef{4, kSize, kSize}));
    EXPECT_TRUE(scene.disparity.isfinite().all().item<bool>());
    nearest = std::min(nearest, scene.disparity.min().item<double>());
    farthest = std::max(farthest, scene.disparity.max().item<double>());
  }
  EXPECT_LT(nearest, -1.5);
  EXPECT_GT(farthest, 1.5);
  EXPECT_GT(nearest, -3.2 - 1.5);  // and the deepest relief
  EXPECT_LT(farthest, 3.2 + 3.5);
}

TEST(KnownScenes, AreTheSameWhereverARunBegins) {
  KnownScenes whole({}, options(), 3, torch::kCPU), resumed({}, options(), 3, torch::kCPU);
  torch::Tensor views;
  for (uint64_t number = 0; number < 12; ++number) views = whole.at(number).views;
  EXPECT_TRUE(torch::equal(resumed.at(11).views, views));
  EXPECT_TRUE(torch::equal(whole.at(11).views, views)) << "again";
  EXPECT_TRUE(torch::equal(whole.at(40).views, resumed.at(40).views));
}

}  // namespace
}  // namespace e2lf::learn
