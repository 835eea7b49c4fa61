// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "testing/test_light.h"

namespace e2lf::streams {
namespace {

StreamOptions clean_v2e() {
  StreamOptions options;
  options.model = StreamModel::kV2e;
  options.v2e = v2e_preset("clean").value();
  options.v2e.sigma_thres = 0;
  return options;
}

/// v2e's logarithm of an intensity of 0 to 1.
double lin_log(double light) {
  const double number = 255 * light;
  return number <= 20 ? number * std::log(20.0) / 20 : std::log(number);
}

TEST(V2eStream, HasTheDefaultsAndPresetsOfV2e) {
  const V2eOptions plain;
  EXPECT_EQ(plain.pos_thres, 0.2F);
  EXPECT_EQ(plain.sigma_thres, 0.03F);
  EXPECT_EQ(plain.cutoff_hz, 300.0F);
  EXPECT_EQ(plain.refractory_period_s, 0.0005F);
  const auto noisy = v2e_preset("noisy").value();
  EXPECT_EQ(noisy.sigma_thres, 0.05F);
  EXPECT_EQ(noisy.cutoff_hz, 30.0F);
  EXPECT_EQ(noisy.shot_noise_rate_hz, 5.0F);
  const auto clean = v2e_preset("clean").value();
  EXPECT_EQ(clean.cutoff_hz + clean.leak_rate_hz + clean.shot_noise_rate_hz + clean.refractory_period_s, 0.0F);
}

TEST(V2eStream, AStepFillsTheSlotsOfOneFrame) {
  auto options = clean_v2e();
  options.v2e.frame_us = 1000;
  TestLight light(options);
  light.show(0.02F, 5000);
  light.show(0.8F, 5000);
  const auto expected = static_cast<size_t>((lin_log(0.8) - lin_log(0.02)) / static_cast<double>(0.2F));
  ASSERT_EQ(light.events().size(), expected);
  for (size_t i = 0; i < expected; ++i) {
    const double slot_us = 5000 + 1000 * static_cast<double>(i + 1) / static_cast<double>(expected);
    EXPECT_EQ(light.events().t[i], static_cast<int64_t>(slot_us + 1e-6));
  }
}

TEST(V2eStream, APixelWithFewerEventsHasTheFirstSlots) {
  auto options = clean_v2e();
  options.v2e.frame_us = 1000;
  TestLight light(options, 1, 2);
  light.show(0.2F, 1000);
  const float once = static_cast<float>(0.2 * std::exp(0.25)), five_times = static_cast<float>(0.2 * std::exp(1.05));
  light.show(std::vector<float>{once, five_times}, 1000);
  ASSERT_EQ(light.events().size(), 6U);
  EXPECT_EQ(light.events()[0], (recordings::Event{0, 0, 1, 1200}));
  EXPECT_EQ(light.events()[1], (recordings::Event{1, 0, 1, 1200}));
  EXPECT_EQ(light.events()[5], (recordings::Event{1, 0, 1, 1999}));  // 2000 is the next pattern's
}

TEST(V2eStream, ASinusoidMakesOneEventForEachThreshold) {
  auto options = clean_v2e();
  options.v2e.frame_us = 100;
  TestLight light(options);
  light.follow([](double t) { return 0.3 * std::exp(0.7 * std::sin(2 * std::numbers::pi * 50 * t)); }, 19200, 100);
  EXPECT_EQ(light.num_on(), 5U);
  EXPECT_EQ(light.events().size(), 11U);
  EXPECT_EQ(light.sum(), -1);
  EXPECT_NEAR(light.events().t[0], std::asin(0.2 / 0.7) / (2 * std::numbers::pi * 50) * 1e6, 100);
}

TEST(V2eStream, TheLowPassIsSlowerInTheDark) {
  for (const float bright : {0.2F, 0.9F}) {
    auto options = clean_v2e();
    options.v2e.cutoff_hz = 30;
    options.v2e.pos_thres = 0.02F;
    options.v2e.frame_us = 20;
    TestLight light(options);
    light.show(0.1F, 1000);
    light.show(bright, 2000);
    const double inten01 = (255 * static_cast<double>(bright) + 20) / 275;
    const double step = lin_log(static_cast<double>(bright)) - lin_log(0.1);
    const double share = 1 - std::exp(-inten01 * 2 * std::numbers::pi * 30 * 2e-3);
    EXPECT_NEAR(static_cast<double>(light.events().size()), step * share / 0.02, 1.5);
  }
}

TEST(V2eStream, ALeakMakesOnEventsAtItsRate) {
  auto options = clean_v2e();
  options.v2e.leak_rate_hz = 3;
  options.v2e.leak_jitter_fraction = 0.1F;
  options.v2e.noise_rate_cov_decades = 0.1F;
  options.v2e.frame_us = 10000;
  TestLight light(options, 40, 40);
  light.show(0.5F, 10000000);
  EXPECT_EQ(light.num_on(), light.events().size());
  // Rates are spread log-normally; the half event that each pixel has not finished is missing.
  const double mean_factor = std::exp(0.5 * std::pow(0.1 * std::log(10.0), 2));
  EXPECT_NEAR(static_cast<double>(light.events().size()) / 1600, 30 * mean_factor - 0.5, 0.6);
}

TEST(V2eStream, ShotNoiseFallsWithLightAndHasBothSigns) {
  for (const float bright : {0.0F, 1.0F}) {
    auto options = clean_v2e();
    options.v2e.shot_noise_rate_hz = 20;
    options.v2e.frame_us = 1000;
    TestLight light(options, 50, 50);
    light.show(bright, 2000000);
    const double inten01 = (255 * static_cast<double>(bright) + 20) / 275;
    const double expected = 20 * (1 - 0.75 * inten01) * 2 * 2500;
    EXPECT_NEAR(static_cast<double>(light.events().size()), expected, 4 * std::sqrt(expected));
    EXPECT_NEAR(static_cast<double>(light.num_on()), expected / 2, 4 * std::sqrt(expected / 4));
  }
}

TEST(V2eStream, ThresholdsAreNormalFromPixelToPixel) {
  constexpr size_t kSide = 64;
  auto options = clean_v2e();
  options.v2e.sigma_thres = 0.03F;
  options.v2e.frame_us = 1000;
  TestLight light(options, kSide, kSide);
  light.ramp(0.3F, 0.45F, 1000000);
  // Events come at the end of their frame.
  const auto thresholds = first_thresholds(light.events(), kSide, kSide,
                                           [](double t_us) { return std::log(1 + 0.5 * (t_us * 1e-6 - 0.0005)); });
  EXPECT_EQ(thresholds.count, kSide * kSide);
  EXPECT_NEAR(thresholds.mean, 0.2, 0.002);
  EXPECT_NEAR(thresholds.deviation, 0.03, 0.001);
}

TEST(V2eStream, AnEventInTheRefractoryPeriodComesLater) {
  auto options = clean_v2e();
  options.v2e.frame_us = 1000;
  options.v2e.refractory_period_s = 0.0025F;
  TestLight light(options);
  light.show(0.2F, 1000);
  light.show(static_cast<float>(0.2 * std::exp(0.65)), 20000);
  // Three thresholds at once. The base stays behind, and the rest comes in frames that are not in the period.
  ASSERT_EQ(light.events().size(), 3U);
  for (size_t i = 1; i < 3; ++i) EXPECT_GT(light.events().t[i] - light.events().t[i - 1], 2500);
  EXPECT_LT(light.events().t[2], 9000);
}

}  // namespace
}  // namespace e2lf::streams
