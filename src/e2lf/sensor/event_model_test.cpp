// SPDX-License-Identifier: MIT
#include "e2lf/sensor/event_model.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "e2lf/base/isa.h"
#include "e2lf/base/log.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/threads.h"
#include "testing/event_reference.h"

namespace e2lf::sensor {
namespace {

constexpr capture::SensorConstants kNoiseFree = {.eps = 0.01F, .tau = 0.30F, .sigma_w = 0, .sigma_z = 0};

EventModelOptions noise_free(EventModel model = EventModel::kReferenceAware) {
  return {.model = model, .constants = kNoiseFree};
}

/// One pixel whose log intensities ln(I + eps) are the given ones.
CodedIntensities pixel_with_logs(const std::vector<double>& logs) {
  CodedIntensities intensities(logs.size(), 1, 1);
  for (size_t n = 0; n < logs.size(); ++n) {
    intensities.values[n] = static_cast<float>(std::exp(logs[n]) - double{kNoiseFree.eps});
  }
  return intensities;
}

CodedIntensities constant(size_t num_patterns, size_t height, size_t width, float value) {
  CodedIntensities intensities(num_patterns, height, width);
  for (float& v : intensities.values) v = value;
  return intensities;
}

/// Black first, then noise from dark to bright.
CodedIntensities random_intensities(size_t num_patterns, size_t height, size_t width) {
  CodedIntensities intensities(num_patterns, height, width);
  const CounterRng rng(3, 0);
  for (size_t i = intensities.image_size(); i < intensities.values.size(); ++i) {
    intensities.values[i] = std::exp(-6.0F * rng.uniform(i));
  }
  return intensities;
}

capture::EventImages simulate(const CodedIntensities& intensities, const EventModelOptions& options) {
  auto images = simulate_events(intensities, options);
  EXPECT_TRUE(images) << (images ? "" : images.error().text());
  return images ? *std::move(images) : capture::EventImages();
}

struct Moments {
  double mean = 0, deviation = 0;
};

template <typename Values>
Moments moments(const Values& values) {
  Moments result;
  for (const auto value : values) result.mean += value;
  result.mean /= static_cast<double>(values.size());
  for (const auto value : values) result.deviation += (value - result.mean) * (value - result.mean);
  result.deviation = std::sqrt(result.deviation / static_cast<double>(values.size()));
  return result;
}

TEST(EventModel, FirstTransitionFromBlackHasAClosedForm) {
  for (const float intensity : {0.0F, 0.003F, 0.02F, 0.1F, 0.15F, 1.0F}) {
    CodedIntensities intensities = constant(2, 1, 1, intensity);
    intensities.values[0] = 0;
    const auto expected = std::floor(std::log((double{intensity} + 0.01) / 0.01) / 0.3);
    for (const EventModel model : {EventModel::kQuantised, EventModel::kReferenceAware}) {
      EXPECT_EQ(simulate(intensities, noise_free(model)).values[0], expected) << intensity;
    }
  }
}

TEST(EventModel, SceneThatDoesNotChangeMakesNoEvents) {
  for (const EventModel model : {EventModel::kQuantised, EventModel::kReferenceAware}) {
    for (const int16_t count : simulate(constant(4, 3, 7, 0.25F), noise_free(model)).values) EXPECT_EQ(count, 0);
  }
}

TEST(EventModel, TruncatesTowardZero) {
  const auto up = simulate(pixel_with_logs({-4, -4 + 2.9 * 0.3}), noise_free());
  const auto down = simulate(pixel_with_logs({-2, -2 - 2.9 * 0.3}), noise_free());
  EXPECT_EQ(up.values[0], 2);
  EXPECT_EQ(down.values[0], -2);
}

TEST(EventModel, OnlyTheReferenceAwareModelRemembersWhatWasLeftOver) {
  // Three rises of 0.6 thresholds: 0.6, 1.2 (one event), 0.2 + 0.6 = 0.8.
  const auto intensities = pixel_with_logs({-4, -4 + 0.6 * 0.3, -4 + 1.2 * 0.3, -4 + 1.8 * 0.3});
  EXPECT_EQ(simulate(intensities, noise_free(EventModel::kQuantised)).values, (std::vector<int16_t>{0, 0, 0}));
  EXPECT_EQ(simulate(intensities, noise_free(EventModel::kReferenceAware)).values, (std::vector<int16_t>{0, 1, 0}));
}

TEST(EventModel, WithoutBlackFirstTheReferenceIsTheFirstIntensity) {
  const auto images = simulate(pixel_with_logs({-1, -1 - 3.5 * 0.3, -1 + 0.2 * 0.3}), noise_free());
  EXPECT_EQ(images.values, (std::vector<int16_t>{-3, 3}));
}

TEST(EventModel, ResidueTakesItsShareOfTheFirstCountsOnly) {
  // 3.4 thresholds above black: 3 events for the two fifths of the pixels whose residue is below 0.4, else 2.
  CodedIntensities intensities(3, 200, 200);
  for (float& value : intensities.image(1)) value = std::exp(std::log(0.01F) + 3.4F * 0.3F) - 0.01F;
  for (float& value : intensities.image(2)) value = std::exp(std::log(0.01F) + 4.4F * 0.3F) - 0.01F;
  EventModelOptions options = noise_free();
  options.residue = 1.0F;
  const auto images = simulate(intensities, options);
  size_t three = 0;
  for (const int16_t count : images.image(0)) {
    EXPECT_TRUE(count == 2 || count == 3) << count;
    if (count == 3) ++three;
  }
  EXPECT_NEAR(static_cast<double>(three) / 40000, 0.4, 0.01);
  for (const int16_t count : images.image(1)) EXPECT_EQ(count, 1);
}

TEST(EventModel, GainScalesTheScene) {
  const CodedIntensities dark = random_intensities(4, 13, 17);
  CodedIntensities bright = dark;
  for (float& value : bright.values) value *= 4;
  EventModelOptions options;
  const auto expected = simulate(bright, options);
  options.gain = 4;
  EXPECT_EQ(simulate(dark, options), expected);
}

TEST(EventModel, NegativeAndNanIntensitiesCountAsDark) {
  CodedIntensities bad(2, 1, 2), dark(2, 1, 2);
  bad.values = {-1, std::numeric_limits<float>::quiet_NaN(), 0.5F, 0.5F};
  dark.values = {0, 0, 0.5F, 0.5F};
  for (const std::string& isa : available_isas()) {
    ASSERT_TRUE(set_max_isa(isa));
    EXPECT_EQ(simulate(bad, noise_free()), simulate(dark, noise_free())) << isa;
  }
  ASSERT_TRUE(set_max_isa(""));
}

TEST(EventModel, LogIntensityNoiseHasItsDeviation) {
  // Thresholds of 0.01 resolve the noise finely; the quantised model draws each transition's from zero.
  EventModelOptions options;
  options.model = EventModel::kQuantised;
  options.constants = {.eps = 0.01F, .tau = 0.01F, .sigma_w = 0.5F, .sigma_z = 0};
  const auto images = simulate(constant(4, 200, 200, 0.5F), options);
  std::vector<double> previous;
  for (size_t k = 0; k < images.count; ++k) {
    std::vector<double> noise, product;
    for (const int16_t count : images.image(k)) noise.push_back(0.01 * count);
    const Moments m = moments(noise);
    EXPECT_NEAR(m.mean, 0, 0.01);
    EXPECT_NEAR(m.deviation, 0.5, 0.01);
    for (size_t i = 0; i < previous.size(); ++i) product.push_back(noise[i] * previous[i]);
    if (k > 0) {
      EXPECT_NEAR(moments(product).mean, 0, 0.25 * 0.02) << "transitions must be independent";
    }
    previous = noise;
  }
}

TEST(EventModel, ThresholdNoiseHasItsDeviation) {
  // A rise by ln(1e30), about 69, over a threshold near 0.3: its count tells the threshold within half a percent.
  EventModelOptions options;
  options.constants = {.eps = 1e-30F, .tau = 0.30F, .sigma_w = 0, .sigma_z = 0.04F};
  CodedIntensities intensities = constant(2, 200, 200, 1.0F);
  for (float& value : intensities.image(0)) value = 0;
  std::vector<double> thresholds;
  for (const int16_t count : simulate(intensities, options).values)
    thresholds.push_back(std::log(1e30) / (count + 0.5));
  const Moments m = moments(thresholds);
  EXPECT_NEAR(m.mean, 0.30, 0.001);
  EXPECT_NEAR(m.deviation, 0.04, 0.001);
}

TEST(EventModel, ThresholdNeverFallsBelowItsFloor) {
  EventModelOptions options;
  options.constants = {.eps = 1e-30F, .tau = 0.30F, .sigma_w = 0, .sigma_z = 1.0F};
  CodedIntensities intensities = constant(2, 50, 50, 1.0F);
  for (float& value : intensities.image(0)) value = 0;
  const auto limit = static_cast<int16_t>(std::log(1e30) / double{kMinThreshold});
  int16_t largest = 0;
  for (const int16_t count : simulate(intensities, options).values) {
    EXPECT_GT(count, 0);
    largest = std::max(largest, count);
  }
  EXPECT_NEAR(largest, limit, 1);
}

TEST(EventModel, SeedChoosesTheNoiseAndNothingElse) {
  const CodedIntensities intensities = random_intensities(4, 40, 40);
  EventModelOptions one, two;
  two.seed = uint64_t{1} << 40;
  EXPECT_EQ(simulate(intensities, one), simulate(intensities, one));
  EXPECT_NE(simulate(intensities, one), simulate(intensities, two));
  one.constants = two.constants = kNoiseFree;
  EXPECT_EQ(simulate(intensities, one), simulate(intensities, two));
}

std::vector<EventModelOptions> every_model_without_and_with_residue() {
  std::vector<EventModelOptions> all;
  for (const EventModel model : {EventModel::kQuantised, EventModel::kReferenceAware}) {
    for (const float residue : {0.0F, 0.9F}) all.push_back({.model = model, .residue = residue});
  }
  return all;
}

TEST(EventModel, EveryInstructionSetAndThreadCountGivesTheSameEvents) {
  const CodedIntensities intensities = random_intensities(6, 67, 71);
  for (EventModelOptions options : every_model_without_and_with_residue()) {
    options.seed = 77;
    const auto expected = simulate(intensities, options);
    for (const std::string& isa : available_isas()) {
      ASSERT_TRUE(set_max_isa(isa));
      for (const int threads : {1, 4}) {
        set_num_threads(threads);
        EXPECT_EQ(simulate(intensities, options), expected) << isa << ", threads: " << threads;
      }
    }
    ASSERT_TRUE(set_max_isa(""));
    set_num_threads(0);
  }
}

TEST(EventModel, AgreesWithTheReference) {
  const CodedIntensities intensities = random_intensities(5, 300, 301);
  for (EventModelOptions options : every_model_without_and_with_residue()) {
    options.seed = 5;
    const auto images = simulate(intensities, options);
    const auto expected = reference_simulate_events(intensities, options);
    ASSERT_TRUE(expected);
    size_t different = 0;
    for (size_t i = 0; i < images.values.size(); ++i) {
      if (images.values[i] != expected->values[i]) ++different;
    }
    EXPECT_LE(different, 6U) << "of " << images.values.size();
  }
}

TEST(EventModel, LightFieldAndItsCodedIntensitiesGiveTheSameEvents) {
  lightfield::LightField light_field({2, 3, 50, 61});
  capture::Codes codes(4, 2, 3);
  const CounterRng rng(9, 0);
  for (size_t i = 0; i < light_field.data().size(); ++i) light_field.data()[i] = rng.uniform(i);
  for (size_t i = 6; i < codes.values.size(); ++i) codes.values[i] = static_cast<float>(rng.below(i, 2));
  const auto direct = simulate_events(codes, light_field, {});
  const auto intensities = coded_intensities(codes, light_field);
  ASSERT_TRUE(direct);
  ASSERT_TRUE(intensities);
  EXPECT_EQ(*direct, simulate(*intensities, {}));
}

TEST(EventModel, CountsBeyondInt16AreSaturatedWithAWarning) {
  EventModelOptions options;
  options.constants.sigma_w = 1e6F;
  int warnings = 0;
  const LogSink previous = set_log_sink([&](LogLevel, const std::string&) { ++warnings; });
  const auto images = simulate(constant(2, 10, 10, 0.5F), options);
  EXPECT_EQ(warnings, 1);
  simulate(constant(2, 10, 10, 0.5F), {});
  EXPECT_EQ(warnings, 1);
  set_log_sink(previous);
  EXPECT_EQ(*std::max_element(images.values.begin(), images.values.end()), std::numeric_limits<int16_t>::max());
  EXPECT_EQ(*std::min_element(images.values.begin(), images.values.end()), std::numeric_limits<int16_t>::min());
}

TEST(EventModel, UnusableOptionsAreRefused) {
  const auto code_of = [](const EventModelOptions& options, size_t num_patterns) {
    const auto images = simulate_events(constant(num_patterns, 2, 2, 0.5F), options);
    return images ? ErrorCode::kInternal : images.error().code;
  };
  EventModelOptions eps, tau, noise, gain, residue, no_residue;
  eps.constants.eps = 0;
  tau.constants.tau = std::numeric_limits<float>::quiet_NaN();
  noise.constants.sigma_w = -0.1F;
  gain.gain = std::numeric_limits<float>::infinity();
  residue.residue = 1.1F;
  no_residue.residue = std::numeric_limits<float>::quiet_NaN();
  for (const EventModelOptions& options : {eps, tau, noise, gain, residue, no_residue}) {
    EXPECT_EQ(code_of(options, 2), ErrorCode::kInvalidValue);
  }
  EXPECT_EQ(code_of({}, 1), ErrorCode::kShape);
}

TEST(EventModel, NamesRoundTrip) {
  for (const EventModel model : {EventModel::kQuantised, EventModel::kReferenceAware}) {
    const auto read = event_model_from_name(event_model_name(model));
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, model);
  }
  EXPECT_FALSE(event_model_from_name("exact"));
}

}  // namespace
}  // namespace e2lf::sensor
