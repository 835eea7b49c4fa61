// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "e2lf/base/isa.h"
#include "testing/pixel_levels.h"
#include "testing/test_light.h"

namespace e2lf::streams {
namespace {

using enum capture::PixelConstant;
constexpr double kDarkLevel = 0.01;

/// What the fast nodes and the reference must both do.
class PixelStream : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { ASSERT_TRUE(set_max_isa(GetParam())); }
  void TearDown() override { ASSERT_TRUE(set_max_isa("")); }
};
INSTANTIATE_TEST_SUITE_P(FastAndReference, PixelStream, testing::Values("", "scalar"));

TEST_P(PixelStream, IsEquations9And10ExactlyWithoutLagAndMismatch) {
  constexpr size_t kHeight = 50, kWidth = 60, kPatterns = 5;
  const auto options = ideal_pixels();
  TestLight light(options, kHeight, kWidth);
  const CounterRng rng(1, 0);
  std::vector<double> reference(kHeight * kWidth, std::log(kDarkLevel));
  std::vector<int> expected, found((kPatterns - 1) * kHeight * kWidth);
  const double tau = options.pixel[kThresholdOn], eps = options.pixel[kEps];
  for (size_t n = 0; n < kPatterns; ++n) {
    std::vector<float> image(kHeight * kWidth);
    for (size_t i = 0; n > 0 && i < image.size(); ++i) image[i] = rng.uniform(n * image.size() + i);
    light.show(image, 1000);
    for (size_t i = 0; n > 0 && i < image.size(); ++i) {
      const double count = std::trunc((std::log(image[i] + eps) - reference[i]) / tau);
      reference[i] += tau * count;
      expected.push_back(static_cast<int>(count));
    }
    if (n == 0) std::fill(reference.begin(), reference.end(), std::log(eps));
  }
  for (size_t i = 0; i < light.events().size(); ++i) {
    const auto event = light.events()[i];
    ASSERT_LT(event.t % 1000, 100);
    found[static_cast<size_t>(event.t / 1000 - 1) * kHeight * kWidth + event.y * kWidth + event.x] +=
        event.p != 0 ? 1 : -1;
  }
  EXPECT_EQ(found, expected);
}

TEST_P(PixelStream, AStepIsPassedWhenPhotoreceptorAndAmplifierHaveFollowed) {
  constexpr double kReceptor = 30.0, kAmplifier = 250.0, kLight = 0.4, kThreshold = 0.05;
  auto options = ideal_pixels(static_cast<float>(kThreshold));
  options.pixel[kReceptorRate] = static_cast<float>(kReceptor);
  options.pixel[kAmplifierRate] = static_cast<float>(kAmplifier);
  TestLight light(options, 1, 1);
  light.show(0.0F, 1000);
  light.show(static_cast<float>(kLight), 12000);
  const double exposure = kLight / kDarkLevel + 1;
  const auto level = [&](double t_us) {
    const double inverse = 1 / exposure + (1 - 1 / exposure) * std::exp(-kReceptor * exposure * t_us * 1e-6);
    return -std::log(inverse) * (1 - std::exp(-kAmplifier * t_us * 1e-6));
  };
  ASSERT_EQ(light.events().size(), static_cast<size_t>(level(12000) / kThreshold));
  for (size_t i = 0; i < light.events().size(); ++i) {
    const double crossed = static_cast<double>(i + 1) * static_cast<double>(options.pixel[kThresholdOn]);
    const auto t_us = static_cast<double>(light.events().t[i] - 1000);
    EXPECT_LE(level(t_us), crossed + 1e-6) << i;
    EXPECT_GE(level(t_us + 1), crossed - 1e-6) << i;
  }
}

TEST_P(PixelStream, ARampFollowsThePhotoreceptorsDifferentialEquation) {
  constexpr double kReceptor = 30.0, kThreshold = 0.02, kRiseS = 0.004;
  auto options = ideal_pixels(static_cast<float>(kThreshold));
  options.pixel[kReceptorRate] = static_cast<float>(kReceptor);
  TestLight light(options, 1, 1);
  light.show(0.0F, 1000);
  light.ramp(0.0F, 0.5F, 4000);
  light.ramp(0.5F, 0.05F, 4000);
  // Where the equation, in small steps, passes the k-th threshold up.
  double u = 0, t = 0;
  constexpr double kStep = 1e-8;
  for (size_t i = 0; t < kRiseS; t += kStep) {
    u += kStep * kReceptor * (1 + 50 * t / kRiseS - std::exp(u));
    if (u < static_cast<double>(i + 1) * kThreshold) continue;
    ASSERT_LT(i, light.events().size());
    EXPECT_NEAR(light.events().t[i++], 1000 + t * 1e6, 0.01 * t * 1e6 + 2);
  }
  const double top = u;
  for (t = 0; t < kRiseS; t += kStep) u += kStep * kReceptor * (51 - 45 * t / kRiseS - std::exp(u));
  EXPECT_NEAR(static_cast<double>(light.sum(0) - light.sum(5000)) * kThreshold, top, 2 * kThreshold);
  EXPECT_NEAR(static_cast<double>(light.sum()) * kThreshold, u, 2 * kThreshold);
}

TEST_P(PixelStream, ASinusoidIsCrossedAtItsArcsines) {
  TestLight light(ideal_pixels(), 1, 1);
  constexpr double kHz = 50.0;
  light.follow([](double t) { return light_of_log(-2.0 + std::sin(2 * std::numbers::pi * kHz * t)); }, 19200, 20);
  ASSERT_EQ(light.events().size(), 11U);
  EXPECT_EQ(light.num_on(), 5U);
  for (int k = 1; k <= 3; ++k) {
    const double t_us = std::asin(k * 0.3) / (2 * std::numbers::pi * kHz) * 1e6;
    EXPECT_NEAR(light.events().t[static_cast<size_t>(k) - 1], t_us, 6);
  }
}

/// A light whose logarithm rises by `per_s` in a second.
void rise(TestLight& light, double per_s, int64_t duration_us) {
  light.follow([=](double t) { return light_of_log(-4.0 + per_s * t); }, duration_us, 1000);
}

TEST_P(PixelStream, ABlindPixelStartsFromTheLevelItHasAfterwards) {
  auto options = ideal_pixels();
  options.defects.refractory_us = 50000;
  TestLight light(options, 1, 1);
  rise(light, 3.0, 1590000);  // a threshold in 100 ms, then 50 ms of nothing
  ASSERT_EQ(light.events().size(), 10U);
  for (size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(light.events().t[i], 100000 + 150000 * static_cast<double>(i), 100);
  }
}

TEST_P(PixelStream, ABlindPixelLosesTheRestOfAStep) {
  auto options = ideal_pixels();
  options.defects.refractory_us = 500;
  TestLight light(options, 1, 1);
  light.show(0.0F, 1000);
  light.show(0.5F, 10000);
  EXPECT_EQ(light.events().size(), 1U);
}

TEST_P(PixelStream, ALeakMakesEventsAtItsRate) {
  auto options = ideal_pixels();
  options.defects.leak_rate_hz = 2;
  TestLight light(options, 10, 10);
  for (int second = 0; second < 10; ++second) light.show(0.3F, 1000100);
  ASSERT_EQ(light.events().size(), 2000U);
  EXPECT_EQ(light.num_on(), 2000U);
  for (size_t i = 0; i < 2000; ++i) EXPECT_NEAR(light.events().t[i], 5e5 * static_cast<double>(i / 100 + 1), 2);
}

TEST_P(PixelStream, ShotEventsAreRarerInLightAndOfBothSigns) {
  constexpr double kHz = 5.0, kSeconds = 10.0, kPixels = 2500;
  auto options = ideal_pixels();
  options.defects.shot_rate_hz = kHz;
  TestLight dark(options, 50, 50), lit(options, 50, 50);
  for (int second = 0; second < 10; ++second) {
    dark.show(0.0F, 1000000);
    lit.show(0.04F, 1000000);
  }
  const double expected = kHz * kSeconds * kPixels;
  EXPECT_NEAR(static_cast<double>(dark.events().size()), expected, 4 * std::sqrt(expected));
  EXPECT_NEAR(static_cast<double>(lit.events().size()), expected / 5, 4 * std::sqrt(expected / 5));
  EXPECT_NEAR(static_cast<double>(dark.num_on()), expected / 2, 4 * std::sqrt(expected / 4));
  // Chance makes the variance of a pixel's count its mean.
  std::vector<double> counts(static_cast<size_t>(kPixels));
  for (size_t i = 0; i < dark.events().size(); ++i) counts[dark.events().y[i] * size_t{50} + dark.events().x[i]] += 1;
  double variance = 0;
  for (const double count : counts) variance += (count - kHz * kSeconds) * (count - kHz * kSeconds) / kPixels;
  EXPECT_NEAR(variance, kHz * kSeconds, 0.12 * kHz * kSeconds);
}

TEST_P(PixelStream, HotPixelsFireAllTheTimeAndStayTheSame) {
  auto options = ideal_pixels();
  options.defects.hot_share = 0.02;
  options.defects.hot_rate_hz = 400;
  options.map_seed = 3;
  TestLight light(options, 100, 100);
  light.show(0.5F, 500000);
  light.show(0.5F, 500000);
  std::vector<int> first(10000), second(10000);
  for (size_t i = 0; i < light.events().size(); ++i) {
    const auto event = light.events()[i];
    ++(event.t < 500000 ? first : second)[event.y * size_t{100} + event.x];
  }
  size_t hot = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i] > 0, second[i] > 0);
    hot += first[i] > 0 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(hot), 200, 4 * std::sqrt(200.0));
  EXPECT_NEAR(static_cast<double>(light.events().size()) / static_cast<double>(hot), 400, 8);
}

TEST_P(PixelStream, ThresholdsDifferFromPixelToPixelAsStated) {
  constexpr size_t kSide = 150;
  auto options = ideal_pixels();
  options.pixel[kMismatch] = 0.08F;
  options.pixel[kMismatchEach] = 0.06F;
  TestLight light(options, kSide, kSide);
  light.show(0.1F, 1000);
  light.ramp(0.1F, 0.35F, 1000000);
  const auto thresholds = first_thresholds(
      light.events(), kSide, kSide, [](double t_us) { return std::log((0.11 + 0.25 * (t_us - 1000) * 1e-6) / 0.11); });
  EXPECT_NEAR(thresholds.mean, 0.3, 0.001);
  EXPECT_NEAR(thresholds.deviation, 0.3 * std::hypot(0.08, 0.06), 0.0006);
}

TEST(PixelStreamNodes, TheFastOnesMakeTheEventsOfTheReference) {
  auto options = ideal_pixels();
  options.pixel[kReceptorRate] = 26.5F;
  options.pixel[kAmplifierRate] = 279.0F;
  options.pixel[kMismatch] = options.pixel[kNoise] = options.pixel[kDarkOff] = 0.1F;
  options.defects = {.refractory_us = 100, .leak_rate_hz = 1, .shot_rate_hz = 10, .hot_share = 0.01};
  std::vector<float> bright(61 * 77);
  for (size_t i = 0; i < bright.size(); ++i) bright[i] = static_cast<float>(i) / 4697.0F;
  TestLight fast(options, 61, 77), reference(options, 61, 77);
  for (TestLight* light : {&fast, &reference}) {
    ASSERT_TRUE(set_max_isa(light == &reference ? "scalar" : ""));
    light->show(0.0F, 15000);
    light->show(bright, 10000);
    light->ramp(0.5F, 0.02F, 10000);
  }
  ASSERT_TRUE(set_max_isa(""));
  ASSERT_EQ(fast.events().size(), reference.events().size());
  size_t different = 0;
  for (size_t i = 0; i < fast.events().size(); ++i) different += fast.events()[i] == reference.events()[i] ? 0 : 1;
  EXPECT_LE(different, 4U);  // times within rounding of a whole microsecond
}

TEST_P(PixelStream, AgreesWithTheOtherFormsOfThePhysicalPixel) {
  constexpr float kThreshold = 0.01F;
  auto options = ideal_pixels(kThreshold);
  options.pixel = capture::lagging_camera(kThreshold).pixel;
  TestLight light(options, 1, 1);
  light.show(static_cast<float>(capture::kInverseLight), 1000);
  const auto levels = capture::pixel_levels(options.pixel);
  for (size_t n = 0; n < 4; ++n) {
    const int64_t before = light.sum();
    light.show(static_cast<float>(capture::kPatternLight[n]), n == 0 ? 15600 : 10400);
    if (n == 0) continue;
    EXPECT_NEAR(static_cast<double>(light.sum() - before) * kThreshold, levels[n] - levels[n - 1], 2 * kThreshold) << n;
  }
}

}  // namespace
}  // namespace e2lf::streams
