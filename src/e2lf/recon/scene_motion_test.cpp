// SPDX-License-Identifier: MIT
#include "e2lf/recon/scene_motion.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/base/rng.h"

namespace e2lf::recon {
namespace {

constexpr size_t kHeight = 64, kWidth = 80, kCodes = 4;

/// The share of the light that pattern `code` lets through; a1 is black.
double share(size_t code, double x, double y) {
  return code == 0 ? 0.0 : 0.12 + 0.08 * std::sin(0.31 * x + 0.2 * y + static_cast<double>(code));
}

double scene(double x, double y) {
  return 0.5 + 0.35 * std::sin(0.7 * x) * std::cos(0.5 * y);
}

/// The counts of a whole cycle of a scene that moves by `px_per_pattern` from pattern to pattern, with noise of the log
/// intensity at each.
capture::EventImages play(double px_per_pattern, double noise, uint64_t seed = 7) {
  constexpr double kDark = 0.02, kThreshold = 0.3;
  capture::EventImages images(2 * kCodes, kHeight, kWidth);
  const CounterRng rng(seed, 0);
  for (size_t y = 0; y < kHeight; ++y) {
    for (size_t x = 0; x < kWidth; ++x) {
      double reference = std::log(kDark);
      for (size_t n = 0; n < images.count; ++n) {
        const size_t shown = (n + 1) % (2 * kCodes), code = shown % kCodes;
        const double place = static_cast<double>(x) + px_per_pattern * static_cast<double>(n);
        const double open = share(code, place, static_cast<double>(y));
        const double light = scene(place, static_cast<double>(y)) * (shown < kCodes ? open : 1 - open);
        const size_t draw = (n * kHeight + y) * kWidth + x;
        const double now = std::log(light + kDark) + noise * (rng.uniform(draw) - 0.5) * std::sqrt(12.0);
        const double count = std::trunc((now - reference) / kThreshold);
        images.image(n)[y * kWidth + x] = static_cast<int16_t>(count);
        reference += kThreshold * count;
      }
    }
  }
  return images;
}

TEST(SceneMotion, IsSmallForAStaticSceneAndGrowsWithMotion) {
  for (const double noise : {0.15, 0.2}) {
    EXPECT_LT(std::abs(scene_motion(play(0, noise))), 0.05) << noise;
    const double slow = scene_motion(play(0.2, noise)), fast = scene_motion(play(1, noise));
    EXPECT_GT(fast, kMuchMotion) << noise;
    EXPECT_GT(fast, slow) << noise;
  }
}

/// The sums of the counts over `cycles`, each with noise of its own.
capture::EventImages play_sum(double px_per_pattern, double noise, size_t cycles) {
  capture::EventImages sum = play(px_per_pattern, noise);
  for (size_t cycle = 1; cycle < cycles; ++cycle) {
    const capture::EventImages more = play(px_per_pattern, noise, 7 + cycle);
    for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] = static_cast<int16_t>(sum.values[i] + more.values[i]);
  }
  return sum;
}

TEST(SceneMotion, OfSumsIsThatOfTheirMeans) {
  for (const double px : {0.0, 0.2, 1.0}) {
    const capture::EventImages once = play(px, 0.15);
    capture::EventImages equal = once;
    for (int16_t& count : equal.values) count = static_cast<int16_t>(16 * count);
    EXPECT_NEAR(scene_motion(equal, 16), scene_motion(once), 1e-4) << px;
  }
  for (const double noise : {0.15, 0.2}) {
    EXPECT_LT(std::abs(scene_motion(play_sum(0, noise, 16), 16)), 0.05) << noise;
    EXPECT_GT(scene_motion(play_sum(1, noise, 16), 16), kMuchMotion) << noise;
  }
}

TEST(SceneMotion, IsZeroWhereRoundingExplainsTheDifferences) {
  EXPECT_EQ(scene_motion(play(0, 0)), 0);
}

/// Of 5120 pixels, two or three are expected to change, and seven may by chance.
TEST(SceneMotion, OfASmallImageNeedsMorePixelsThanChance) {
  for (const auto& [pixels, is_motion] : {std::pair(size_t{6}, false), {size_t{30}, true}}) {
    capture::EventImages images = play(0, 0);
    for (size_t i = 0; i < pixels; ++i) images.image(6)[20 * kWidth + 10 + i] += 3;
    EXPECT_EQ(scene_motion(images) != 0, is_motion) << pixels;
  }
}

TEST(SceneMotion, IsZeroWhereNothingTellsOfIt) {
  EXPECT_EQ(scene_motion(capture::EventImages(8, 20, 30)), 0);
  EXPECT_EQ(scene_motion(capture::EventImages(3, 20, 30)), 0);
  EXPECT_EQ(scene_motion(capture::EventImages(4, 20, 30)), 0) << "two patterns";
}

TEST(SceneMotion, TheLitTransitionsAreTheFirstOfTheCycle) {
  const capture::EventImages whole = play(0, 0.1), lit = lit_transitions(whole);
  ASSERT_EQ(lit.count, kCodes - 1);
  for (size_t n = 0; n < lit.count; ++n) {
    EXPECT_TRUE(std::ranges::equal(lit.image(n), whole.image(n))) << n;
  }
}

}  // namespace
}  // namespace e2lf::recon
