// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/plenoptic_camera.h"

#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/learn/data/synthesiser.h"

namespace e2lf::learn {
namespace {

TEST(PlenopticCamera, AddsGrainThatIsIndependentInEachView) {
  const auto shown = PlenopticCamera{.grain = 0.01, .grain_seed = 3}.show(torch::full({64, 48, 48}, 0.5));
  EXPECT_NEAR((shown - 0.5).std().item<double>(), 0.01, 1e-4);
  const auto a = shown[27] - 0.5, b = shown[28] - 0.5;
  EXPECT_LT(std::abs((a * b).mean().item<double>()), 0.1 * 1e-4);
}

TEST(PlenopticCamera, LosesTheContrastOfDetailsTowardsTheCornerViews) {
  auto stripes = torch::full({64, 64, 64}, 0.25);
  stripes.slice(2, 0, 64, 2).fill_(0.75);
  const auto shown = PlenopticCamera{.corner_contrast = 0.8}.show(stripes).slice(1, 16, 48).slice(2, 16, 48);
  const auto contrast = [&](int64_t view) { return shown[view].std().item<double>() / 0.25; };
  EXPECT_NEAR(contrast(0), 0.8, 0.01);
  EXPECT_NEAR(contrast(63), 0.8, 0.01);
  EXPECT_NEAR(contrast(27), 1.0, 0.01);  // next to the centre of the aperture
  EXPECT_NEAR(shown[0].mean().item<double>(), 0.5, 1e-3);
}

TEST(PlenopticCamera, BlursAndDarkensTheCornersOfTheImage) {
  auto point = torch::zeros({64, 33, 33});
  point.select(1, 16).select(1, 16).fill_(1.0);
  const auto spread = PlenopticCamera{.blur_y_px = 0.5, .blur_x_px = 1.0}.show(point)[0];
  const auto place = torch::arange(33) - 16.0;
  EXPECT_NEAR((spread.sum(0) * place.square()).sum().item<double>(), 1.0, 0.05);
  EXPECT_NEAR((spread.sum(1) * place.square()).sum().item<double>(), 0.25, 0.05);
  const auto darker = PlenopticCamera{.corner_brightness = 0.75}.show(torch::ones({64, 33, 33}))[5];
  EXPECT_NEAR(darker[0][0].item<double>(), 0.75, 1e-6);
  EXPECT_NEAR(darker[16][16].item<double>(), 1.0, 1e-6);
}

TEST(Synthesise, ScenesOfPlenopticCamerasDoNotChangeTheOthers) {
  SynthesiserOptions options{.size = 32};
  const auto plain = synthesise({}, options, 5, torch::kCPU);
  options.plenoptic_share = 0.5;
  size_t changed = 0;
  for (uint64_t seed = 0; seed < 8; ++seed) {
    const bool is_same =
        torch::equal(synthesise({}, options, seed, torch::kCPU), synthesise({}, {.size = 32}, seed, torch::kCPU));
    changed += is_same ? 0 : 1;
  }
  EXPECT_GT(changed, 0U);
  EXPECT_LT(changed, 8U);
  options.plenoptic_share = 1.0;
  EXPECT_FALSE(torch::equal(synthesise({}, options, 5, torch::kCPU), plain));
}

}  // namespace
}  // namespace e2lf::learn
