// SPDX-License-Identifier: MIT
#include "e2lf/recon/fusion.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "e2lf/base/isa.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/recon/fusion_kernels.h"
#include "e2lf/recon/input.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::recon {
namespace {

constexpr size_t kSize = 96;

/// Black and four quarters of the aperture.
capture::Codes quarters() {
  capture::Codes codes(5, 8, 8);
  for (size_t cell = 0; cell < 64; ++cell) codes.values[(1 + cell / 32 * 2 + cell % 8 / 4) * 64 + cell] = 1.0F;
  return codes;
}

capture::SensorProfile camera(const std::string& name) {
  if (name == "paper") return {};
  return capture::read_camera(*bundled_file_named(kBundledCameras, name)).value();
}

capture::EventImages play(const capture::Codes& codes, const lightfield::LightField& scene,
                          const capture::SensorProfile& camera, uint64_t seed) {
  if (camera.is_pixel()) return sensor::simulate_pixel_events(codes, scene, camera, {.seed = seed}).value();
  return sensor::simulate_events(codes, scene, {.constants = camera.constants, .seed = seed}).value();
}

/// Adds a bright square of 32 px, whose left edge is at `left`, to every view.
lightfield::LightField with_square(lightfield::LightField field, size_t left) {
  for (size_t view = 0; view < 64; ++view) {
    for (size_t y = 32; y < 64; ++y) {
      float* const row = field.data().data() + (view * kSize + y) * kSize;
      for (size_t x = left; x < left + 32; ++x) row[x] = (x - left) / 4 % 2 == y / 4 % 2 ? 0.9F : 0.2F;
    }
  }
  return field;
}

class Fusion : public testing::TestWithParam<std::tuple<const char*, bool>> {
 protected:
  capture::SensorProfile sensor = camera(std::get<0>(GetParam()));
  capture::Codes codes = std::get<1>(GetParam()) ? capture::whole_cycle(quarters()) : quarters();
  lightfield::LightField scene = lightfield::render_light_field(lightfield::demo_scene(), {8, 8, kSize, kSize, 1});
};

TEST_P(Fusion, OfAStillSceneIsTheMeanOfTheCycles) {
  constexpr size_t kCycles = 8;
  CycleFusion fusion(sensor, kCycles);
  std::vector<double> sums;
  double restarted = 0;
  for (uint64_t seed = 1; seed <= kCycles; ++seed) {
    const capture::EventImages cycle = play(codes, scene, sensor, seed);
    sums.resize(cycle.values.size());
    for (size_t i = 0; i < sums.size(); ++i) sums[i] += cycle.values[i];
    fusion.add(cycle);
    if (seed > 1) restarted += fusion.changed();
  }
  EXPECT_LT(restarted / (kCycles - 1), kFalseAlarmRate);
  size_t different = 0;
  for (size_t i = 0; i < sums.size(); ++i) {
    const bool is_mean = fusion.fused().cycles.values[i % (kSize * kSize)] == kCycles;
    const double mean = fusion.fused().counts.values[i] / static_cast<double>(capture::kFusedUnits);
    different += is_mean && std::abs(mean - sums[i] / kCycles) > 0.05 ? 1 : 0;
  }
  EXPECT_EQ(different, 0U);
}

TEST_P(Fusion, StartsAgainWhereASquareMovesAndNowhereElse) {
  CycleFusion fusion(sensor, 16);
  capture::EventImages last;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    last = play(codes, with_square(scene, 16 + 4 * seed), sensor, seed);
    fusion.add(last);
  }
  size_t stale = 0, moving = 0, kept = 0, still = 0;
  for (size_t y = 0; y < kSize; ++y) {
    for (size_t x = 0; x < kSize; ++x) {
      const float cycles = fusion.fused().cycles.values[y * kSize + x];
      if (y >= 34 && y < 62 && x >= 38 && x < 70) ++moving, stale += cycles > 1 ? 1 : 0;
      // The windows reach 10 px, and what they find is extended by 4 px.
      if (y < 14 || y >= 82) ++still, kept += cycles == 6 ? 1 : 0;
    }
  }
  EXPECT_LT(static_cast<double>(stale), 0.02 * static_cast<double>(moving));
  EXPECT_GT(static_cast<double>(kept), 0.7 * static_cast<double>(still)) << "of five cycles with kFalseAlarmRate each";
  // Pixels that started again hold the last cycle alone.
  for (size_t i = 0; i < last.values.size(); ++i) {
    if (fusion.fused().cycles.values[i % (kSize * kSize)] != 1) continue;
    ASSERT_EQ(fusion.fused().counts.values[i], static_cast<int>(capture::kFusedUnits) * last.values[i]);
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, Fusion, testing::Combine(testing::Values("paper", "evk4-lcos"), testing::Bool()));

TEST(CountNoise, IsSmallWhereNoiseHardlyEverReachesAThreshold) {
  capture::SensorProfile camera;
  camera.constants.tau = 1;
  camera.constants.sigma_w = 0.5303F;  // the variance 4.5 / 16 lies in the middle of an element of the table
  camera.constants.sigma_z = 0;
  const CountNoise noise(camera);
  CountNoise::PixelLevel state;
  const float still = noise.next(0, state);
  const double reaches = std::erfc(1 / 0.5303 / std::sqrt(2.0));  // P(|noise| > 1)
  EXPECT_NEAR(still / reaches, 1.45, 0.15);
  state = {};
  const float large = noise.next(4, state);
  EXPECT_NEAR(large / (0.5303 * 0.5303 + 1 / 12.0), 1.45, 0.15) << "that of the noise and of rounding";
}

TEST(CycleFusion, BoundsTheWeightOfOldCycles) {
  CycleFusion fusion({}, 4);
  for (int cycle = 0; cycle < 40; ++cycle) {
    capture::EventImages images(2, 5, 7);
    std::ranges::fill(images.values, int16_t{3});
    fusion.add(images);
  }
  EXPECT_NEAR(fusion.fused().cycles.values[0], 7, 1e-3);  // 2 x 4 - 1
  EXPECT_TRUE(
      std::ranges::all_of(fusion.fused().counts.values, [](int16_t mean) { return mean == 3 * capture::kFusedUnits; }));
}

TEST(CycleFusion, ShowsTheNewestCycleAloneUntilItsMeanIsSettled) {
  CycleFusion fusion({}, 16);
  const auto add = [&](int16_t count) {
    capture::EventImages images(2, 16, 16);
    std::ranges::fill(images.values, count);
    fusion.add(images);
  };
  for (int cycle = 0; cycle < 3; ++cycle) add(3);
  EXPECT_EQ(fusion.fused().cycles.values[0], 3) << "the first cycle is no change";
  add(20);
  for (int16_t cycle = 0; cycle < kUnsettledCycles; ++cycle) {
    EXPECT_EQ(fusion.fused().cycles.values[0], 1);
    EXPECT_EQ(fusion.fused().counts.values[0], (20 + cycle % 2) * capture::kFusedUnits);
    add(static_cast<int16_t>(20 + (cycle + 1) % 2));
  }
  EXPECT_EQ(fusion.fused().cycles.values[0], 1 + kUnsettledCycles);
  EXPECT_NEAR(fusion.fused().counts.values[0], 20.4 * capture::kFusedUnits, 1) << "the mean of 20, 21, 20, 21, 20";
}

TEST(FusionKernels, ComputeTheSameOnEveryInstructionSet) {
  std::mt19937 random(5);
  for (const size_t width : {1, 3, 16, 77}) {
    std::vector<int16_t> counts(2 * width), means(2 * width);
    std::vector<int16_t> weights(width);
    for (size_t i = 0; i < 2 * width; ++i) {
      counts[i] = static_cast<int16_t>(i % 5 == 0 ? random() : random() % 9);  // some beyond the range of units
      means[i] = static_cast<int16_t>(random());
      weights[i % width] = mean_weight(1 + random() % kMostFusedCycles);
    }
    std::vector<int32_t> expected_sums((width + 1) / kBlock);
    for (size_t i = 0; i < 2 * width; ++i) expected_sums[i % width / kBlock] += units_of(counts[i]) - means[i];
    std::vector<int16_t> expected_means(width);
    for (size_t x = 0; x < width; ++x) {
      const int newest = units_of(counts[x]), difference = std::clamp(newest - means[x], INT16_MIN, INT16_MAX);
      const double moved = std::floor(means[x] + difference * (weights[x] / 32768.0) + 0.5);
      expected_means[x] = static_cast<int16_t>(weights[x] == kWholeWeight ? newest : moved);
    }
    for (const std::string& isa : available_isas()) {
      ASSERT_TRUE(set_max_isa(isa));
      std::vector<int32_t> sums(expected_sums.size(), 7);
      block_residuals({counts.data(), counts.data() + width}, {means.data(), means.data() + width}, width, sums.data());
      EXPECT_EQ(sums, expected_sums) << isa << ", " << width;
      std::vector<int16_t> updated(means.begin(), means.begin() + static_cast<ptrdiff_t>(width));
      add_to_means(counts.data(), weights.data(), width, updated.data());
      EXPECT_EQ(updated, expected_means) << isa << ", " << width;
    }
    ASSERT_TRUE(set_max_isa(""));
  }
}

TEST(FusionKernels, AddTheSameOnEveryInstructionSet) {
  std::mt19937 random(6);
  for (const size_t cells : {1, 3, 16, 77}) {
    // Sums of squares below 2^24 are exact, however they are rounded on the way.
    std::vector<int32_t> residuals(2 * cells);
    for (int32_t& residual : residuals) residual = static_cast<int32_t>(random() % 2001) - 1000;
    std::vector<float> expected_squares(cells, 5), expected_sums(cells, -3), expected_rows(cells);
    for (size_t x = 0; x < cells; ++x) {
      const int32_t left = residuals[2 * x], right = residuals[2 * x + 1];
      expected_squares[x] += static_cast<float>(left * left + right * right);
      expected_sums[x] += static_cast<float>(left + right);
      expected_rows[x] = expected_squares[x] + 2 * expected_sums[x];
    }
    for (const std::string& isa : available_isas()) {
      ASSERT_TRUE(set_max_isa(isa));
      std::vector<float> squares(cells, 5), sums(cells, -3), rows(cells, 9);
      add_squares(residuals.data(), cells, squares.data(), sums.data());
      EXPECT_EQ(squares, expected_squares) << isa << ", " << cells;
      EXPECT_EQ(sums, expected_sums) << isa << ", " << cells;
      sum_rows(std::array<const float*, 3>{squares.data(), sums.data(), sums.data()}, cells, rows.data());
      EXPECT_EQ(rows, expected_rows) << isa << ", " << cells;
    }
    ASSERT_TRUE(set_max_isa(""));
  }
}

TEST(CycleFusion, StartsAgainWithAnotherSize) {
  CycleFusion fusion({}, 4);
  fusion.add(capture::EventImages(2, 5, 7));
  fusion.add(capture::EventImages(2, 5, 7));
  EXPECT_EQ(fusion.changed(), 0);
  fusion.add(capture::EventImages(3, 4, 9));
  EXPECT_EQ(fusion.changed(), 1);
  EXPECT_EQ(fusion.fused().counts.count, 3U);
  EXPECT_EQ(fusion.fused().cycles.values.size(), 36U);
}

TEST(CycleFusion, LimitsCountsOfDamagedPixels) {
  CycleFusion fusion({}, 4);
  capture::EventImages images(1, 2, 2);
  images.values = {INT16_MAX, INT16_MIN, 1, -1};
  fusion.add(images);
  fusion.add(images);
  EXPECT_EQ(fusion.changed(), 0);
  EXPECT_EQ(fusion.fused().counts.values, (std::vector<int16_t>{511 * 64, -512 * 64, 64, -64}));
}

}  // namespace
}  // namespace e2lf::recon
