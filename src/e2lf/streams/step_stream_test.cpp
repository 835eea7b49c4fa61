// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "e2lf/sensor/event_model.h"
#include "testing/event_reference.h"
#include "testing/test_light.h"

namespace e2lf::streams {
namespace {

constexpr StreamModel kPaperModels[] = {StreamModel::kQuantised, StreamModel::kReferenceAware, StreamModel::kEsim};
constexpr double kDarkOffset = 0.01, kTau = 0.3;

TEST(StepStream, AStepMakesItsEventsAMicrosecondApart) {
  for (const StreamModel model : kPaperModels) {
    TestLight light(quiet(model));
    light.show(0.0F, 1000);
    light.show(0.5F, 1000);
    light.show(0.1F, 1000);
    const int on = static_cast<int>(std::log(0.51 / 0.01) / kTau);
    // Eq. 8 forgets what the last step left over.
    const double reference = model == StreamModel::kQuantised ? std::log(0.51) : std::log(0.01) + on * kTau;
    const int off = static_cast<int>((reference - std::log(0.11)) / kTau);
    ASSERT_EQ(light.events().size(), static_cast<size_t>(on + off)) << stream_model_name(model);
    EXPECT_EQ(light.num_on(), static_cast<size_t>(on));
    EXPECT_EQ(light.events().t[0], 1000);
    EXPECT_EQ(light.events().t[static_cast<size_t>(on) - 1], 1000 + on - 1);
    EXPECT_EQ(light.events().t[static_cast<size_t>(on)], 2000);
    EXPECT_EQ(light.events().t.back(), 2000 + off - 1);
  }
}

/// When a ramp of intensity passes the k-th threshold.
double crossing_us(double from, double to, double duration_us, int k) {
  const double light = std::exp(std::log(from + kDarkOffset) + k * kTau) - kDarkOffset;
  return (light - from) / (to - from) * duration_us;
}

TEST(StepStream, ARampIsCrossedWhereTheLogarithmSaysSo) {
  for (const StreamModel model : {StreamModel::kQuantised, StreamModel::kReferenceAware}) {
    TestLight light(quiet(model));
    light.show(0.02F, 1000);
    light.ramp(0.02F, 0.9F, 20000);
    ASSERT_EQ(light.events().size(), static_cast<size_t>(std::log(0.91 / 0.03) / kTau));
    for (size_t i = 0; i < light.events().size(); ++i) {
      EXPECT_NEAR(light.events().t[i], 1000 + crossing_us(0.02, 0.9, 20000, static_cast<int>(i) + 1) - 0.5, 0.6);
    }
  }
}

TEST(StepStream, EsimDrawsAStraightLineThroughTheLogarithms) {
  TestLight light(quiet(StreamModel::kEsim));
  light.show(0.02F, 1000);
  light.ramp(0.02F, 0.9F, 20000);
  const double change = std::log(0.91 / 0.03);
  ASSERT_EQ(light.events().size(), static_cast<size_t>(change / kTau));
  for (size_t i = 0; i < light.events().size(); ++i) {
    EXPECT_NEAR(light.events().t[i], 1000 + static_cast<double>(i + 1) * kTau / change * 20000 - 0.5, 0.6);
  }
}

TEST(StepStream, ASinusoidIsCrossedAtItsArcsines) {
  constexpr double kAmplitude = 1.0, kHz = 50.0;
  for (const StreamModel model : {StreamModel::kReferenceAware, StreamModel::kEsim}) {
    TestLight light(quiet(model));
    const auto wave = [&](double t) {
      return light_of_log(-2.0 + kAmplitude * std::sin(2 * std::numbers::pi * kHz * t));
    };
    light.follow(wave, 19200, 20);
    // Three up, six down, two up again.
    ASSERT_EQ(light.events().size(), 11U);
    EXPECT_EQ(light.num_on(), 5U);
    for (int k = 1; k <= 3; ++k) {
      const double t_us = std::asin(k * kTau / kAmplitude) / (2 * std::numbers::pi * kHz) * 1e6;
      EXPECT_NEAR(light.events().t[static_cast<size_t>(k) - 1], t_us, 6);  // pieces are straight
    }
    // The reference is three thresholds up: the first event down comes where two are left.
    const double down_us = 1e4 - std::asin(2 * kTau / kAmplitude) / (2 * std::numbers::pi * kHz) * 1e6;
    EXPECT_NEAR(light.events().t[3], down_us, 6);
  }
}

TEST(StepStream, SumsAreThoseOfEquations8To10WithTheirNoise) {
  constexpr size_t kHeight = 20, kWidth = 30, kPatterns = 5;
  sensor::CodedIntensities intensities(kPatterns, kHeight, kWidth);
  const CounterRng rng(3, 0);
  for (size_t i = kHeight * kWidth; i < intensities.values.size(); ++i) intensities.values[i] = rng.uniform(i);
  for (const sensor::EventModel model : {sensor::EventModel::kQuantised, sensor::EventModel::kReferenceAware}) {
    const sensor::EventModelOptions paper{.model = model, .seed = 5};
    const auto expected = sensor::reference_simulate_events(intensities, paper).value();
    StreamOptions options;
    options.model = stream_model_from_name(sensor::event_model_name(model)).value();
    options.seed = 5;
    TestLight light(options, kHeight, kWidth);
    capture::EventImages found(kPatterns - 1, kHeight, kWidth);
    for (size_t n = 0; n < kPatterns; ++n) {
      const auto image = intensities.image(n);
      light.show(std::vector<float>(image.begin(), image.end()), 1000);
    }
    for (size_t i = 0; i < light.events().size(); ++i) {
      const auto event = light.events()[i];
      found.image(static_cast<size_t>(event.t / 1000 - 1))[event.y * kWidth + event.x] += event.p != 0 ? 1 : -1;
    }
    EXPECT_EQ(found.values, expected.values) << sensor::event_model_name(model);
  }
}

TEST(StepStream, EsimLosesEventsInTheRefractoryPeriodForGood) {
  auto options = quiet(StreamModel::kEsim);
  options.esim_refractory_us = 1500;
  TestLight light(options);
  light.show(static_cast<float>(light_of_log(-3.0)), 1000);
  // A threshold each millisecond: every second event falls into the period of the one before.
  light.ramp(static_cast<float>(light_of_log(-3.0)), static_cast<float>(light_of_log(-3.0 + 6.5 * kTau)), 6500);
  ASSERT_EQ(light.events().size(), 3U);
  EXPECT_NEAR(light.events().t[0], 2000, 2);
  EXPECT_NEAR(light.events().t[1], 4000, 2);
  EXPECT_NEAR(light.events().t[2], 6000, 2);
}

TEST(StepStream, EsimDrawsItsThresholdsFromANormalDistribution) {
  constexpr size_t kSide = 200;
  auto options = quiet(StreamModel::kEsim, 0.3F);
  options.constants.sigma_z = 0.05F;
  TestLight light(options, kSide, kSide);
  light.show(static_cast<float>(light_of_log(-3.0)), 1000);
  light.ramp(static_cast<float>(light_of_log(-3.0)), static_cast<float>(light_of_log(-2.5)), 500000);
  const auto thresholds =
      first_thresholds(light.events(), kSide, kSide, [](double t_us) { return (t_us - 1000) * 1e-6; });
  EXPECT_GT(thresholds.count, kSide * kSide * 99 / 100);
  EXPECT_NEAR(thresholds.mean, 0.3, 0.001);
  EXPECT_NEAR(thresholds.deviation, 0.05, 0.001);
}

}  // namespace
}  // namespace e2lf::streams
