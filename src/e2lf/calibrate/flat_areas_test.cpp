// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/base/rng.h"
#include "e2lf/calibrate/count_distribution.h"
#include "e2lf/calibrate/still_scene.h"

namespace e2lf::calibrate {
namespace {

constexpr size_t kHeight = 240, kWidth = 480;

/// White noise of standard deviation 0.5 around a mean that `mean_at(n, y, x)` gives.
template <typename MeanAt>
StillScene noisy(const MeanAt& mean_at) {
  StillScene scene{{capture::EventImages(3, kHeight, kWidth)}};
  for (size_t n = 0; n < 3; ++n) {
    for (size_t p = 0; p < kHeight * kWidth; ++p) {
      const float noise = 0.5F * CounterRng(1, n).normal2(p)[0];
      scene.cycles[0].image(n)[p] = static_cast<int16_t>(std::lround(mean_at(n, p / kWidth, p % kWidth) + noise));
    }
  }
  return scene;
}

/// The share of flat pixels in the middle of the left or right half.
double flat_share(const FlatAreas& flat, bool right) {
  size_t count = 0, all = 0;
  for (size_t y = 60; y < kHeight - 60; ++y) {
    for (size_t x = 0; x < kWidth / 2 - 120; ++x, ++all) {
      count += flat.is_flat[y * kWidth + (right ? kWidth / 2 : 0) + 60 + x] ? 1 : 0;
    }
  }
  return static_cast<double>(count) / static_cast<double>(all);
}

FlatAreas flat_areas_of(const StillScene& scene) {
  return find_flat_areas(scene, std::vector<PixelState>(kHeight * kWidth, PixelState::kGood));
}

/// The brightness in the middle of a row.
float brightness_of(size_t row) {
  return kFirstRow + (static_cast<float>(row) + 0.5F) * kRowWidth;
}

TEST(FlatAreas, AreWhereThereIsWhiteNoiseAlone) {
  const auto flat = flat_areas_of(noisy([](size_t, size_t, size_t) { return 1.0F; }));
  EXPECT_GT(flat_share(flat, false), 0.8);
  EXPECT_GT(flat_share(flat, true), 0.8);
  EXPECT_FALSE(flat.is_flat[100]);  // at the edge
  EXPECT_NEAR(flat.brightness.data()[100 * kWidth + 100], 2.0F, 0.15F);
}

TEST(FlatAreas, AreNotWhereTheSceneHasAFineTexture) {
  // Waves of 14 px, half as strong as the noise.
  const auto flat = flat_areas_of(noisy([](size_t, size_t y, size_t x) {
    const auto phase = 2.0F * 3.14159265F / 14.0F;
    return x < kWidth / 2
               ? 1.0F
               : 1.0F + 0.5F * std::sin(phase * static_cast<float>(x)) * std::sin(phase * static_cast<float>(y));
  }));
  EXPECT_GT(flat_share(flat, false), 0.8);
  EXPECT_LT(flat_share(flat, true), 0.02);
}

TEST(FlatAreas, MayHaveASlopeInTheFirstTransitionButNotInTheThird) {
  const auto slope_in = [](size_t transition) {
    return flat_areas_of(noisy([=](size_t n, size_t, size_t x) {
      const bool is_sloped = n == transition && x >= kWidth / 2;
      return is_sloped ? 1.0F + 0.02F * static_cast<float>(x - kWidth / 2) : 1.0F;
    }));
  };
  EXPECT_GT(flat_share(slope_in(0), true), 0.5);
  EXPECT_LT(flat_share(slope_in(2), true), 0.02);
}

TEST(FlatAreas, AreCollectedByBrightnessAndFieldPosition) {
  const StillScene scene = noisy([](size_t n, size_t, size_t x) { return n == 0 && x >= kWidth / 2 ? 2.0F : 1.0F; });
  const auto areas = collect_areas(scene, 0, flat_areas_of(scene), [](size_t, size_t) { return true; });
  ASSERT_FALSE(areas.empty());
  const CountGroup group = count_groups(3).front();
  double samples = 0.0;
  for (const Area& area : areas) {
    double sum = 0.0, mean = 0.0;
    for (size_t cell = 0; cell < area.histogram.size(); ++cell) {
      sum += area.histogram[cell];
      mean += area.histogram[cell] * static_cast<float>(group.count_at(cell / group.num_counts / group.num_counts));
    }
    EXPECT_NEAR(sum, 1.0, 1e-4);
    EXPECT_NEAR(mean + 1.0, brightness_of(area.row), 0.2);
    EXPECT_EQ(area.x > 0.0, mean > 1.5);
    samples += area.samples;
  }
  EXPECT_GT(samples, 0.2 * kHeight * kWidth);
  const auto none = collect_areas(scene, 0, flat_areas_of(scene), [](size_t, size_t) { return false; });
  EXPECT_TRUE(none.empty());
}

TEST(FlatAreas, OfAPictureKnownToBeEvenAreTheCellsOfTheField) {
  const StillScene scene = noisy([](size_t, size_t, size_t x) { return x < kWidth / kFieldColumns ? 2.0F : 1.0F; });
  const auto flat = even_areas(scene, std::vector<PixelState>(kHeight * kWidth, PixelState::kGood));
  const auto areas = collect_areas(scene, 0, flat, [](size_t, size_t) { return true; });
  ASSERT_EQ(areas.size(), kFieldColumns * kFieldRows);
  for (const Area& area : areas) {
    EXPECT_NEAR(brightness_of(area.row), area.cell % kFieldColumns == 0 ? 4.0F : 2.0F, 0.2F);
  }
  EXPECT_FALSE(flat.is_flat[100]);  // at the edge
}

}  // namespace
}  // namespace e2lf::calibrate
