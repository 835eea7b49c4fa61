// SPDX-License-Identifier: MIT
#include "e2lf/streams/virtual_rig.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <gtest/gtest.h>
#include <map>

#include "e2lf/base/progress.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"
#include "testing/test_light.h"

namespace e2lf::streams {
namespace {

using enum capture::PixelConstant;
using lightfield::LightField;

/// Black, then patterns of 9, 12 and 11 open cells.
capture::Codes test_codes() {
  capture::Codes codes(4, 8, 8);
  for (size_t cell = 0; cell < 9; ++cell) codes.pattern(1)[cell] = 1.0F;
  for (size_t cell = 20; cell < 32; ++cell) codes.pattern(2)[cell] = 1.0F;
  for (size_t cell = 40; cell < 51; ++cell) codes.pattern(3)[cell] = 1.0F;
  return codes;
}

constexpr size_t kLevels = 8, kRows = 10, kWidth = 250;

/// Bands of kRows rows, each of one brightness; the same in all views.
LightField bands(float brightest) {
  LightField field({8, 8, kLevels * kRows, kWidth});
  for (size_t i = 0; i < field.data().size(); ++i) {
    const size_t level = i / kWidth / kRows % kLevels;
    field.data()[i] = brightest * std::exp2(static_cast<float>(level) - static_cast<float>(kLevels - 1));
  }
  return field;
}

MovingScene still(LightField field) {
  return {[field = std::move(field)](uint64_t) { return Result<LightField>(field); }, 0};
}

VirtualRig make_rig(const StreamOptions& stream, MovingScene scene, const capture::SensorProfile& camera = {},
                    const RigOptions& options = {}) {
  return VirtualRig::create(test_codes(), camera, stream, options, std::move(scene), kLevels * kRows, kWidth).value();
}

TEST(VirtualRig, ShowsTheEightPatternsWithATriggerEach) {
  auto rig = make_rig(quiet(StreamModel::kReferenceAware), still(bands(1.0F)));
  for (int cycle = 0; cycle < 2; ++cycle) {
    const auto batch = rig.play_cycle().value();
    ASSERT_EQ(batch.triggers.size(), 16U);
    int64_t t_us = 100000 + cycle * cycles::paper_schedule().cycle_us();
    for (size_t i = 0; i < 8; ++i) {
      EXPECT_EQ(batch.triggers[2 * i], (recordings::Trigger{t_us, 0, 1}));
      EXPECT_EQ(batch.triggers[2 * i + 1], (recordings::Trigger{t_us + 500, 0, 0}));
      t_us += cycles::paper_schedule().patterns[i].interval_us();
    }
    EXPECT_TRUE(std::is_sorted(batch.events.t.begin(), batch.events.t.end()));
  }
}

TEST(VirtualRig, EndsWithinACycleIfAStopIsRequested) {
  int requested = 0;
  MovingScene scene{[&](uint64_t) {
                      if (++requested == 3) request_stop(SIGINT);
                      return Result<LightField>(bands(1.0F));
                    },
                    1000};
  auto rig = make_rig(quiet(StreamModel::kReferenceAware), std::move(scene));
  const auto stopped = rig.play_cycle();
  request_stop(0);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  EXPECT_LE(requested, 4);
}

TEST(VirtualRig, CarriesReferencesFromCycleToCycle) {
  auto rig = make_rig(quiet(StreamModel::kReferenceAware), still(bands(0.8F)));
  const auto first = rig.sum_windows(rig.play_cycle().value());
  const auto batch = rig.play_cycle().value();
  const auto second = rig.sum_windows(batch), third = rig.sum_windows(rig.play_cycle().value());
  // Without noise the cycle repeats itself, and each pixel ends it where it began.
  EXPECT_EQ(second, third);
  std::vector<int> sums(kLevels * kRows * kWidth);
  for (size_t i = 0; i < batch.events.size(); ++i) {
    sums[batch.events.y[i] * kWidth + batch.events.x[i]] += batch.events.p[i] != 0 ? 1 : -1;
  }
  EXPECT_EQ(sums, std::vector<int>(sums.size()));
  EXPECT_GT(*std::max_element(first.values.begin(), first.values.end()), 3);
}

TEST(VirtualRig, ACycleThatBeginsWithBlackHasTheCountsOfEquations9And10) {
  const auto field = bands(0.8F);
  RigOptions options;
  options.schedule = cycles::plain_schedule(4, 10000);
  auto rig = make_rig(quiet(StreamModel::kReferenceAware), still(field), {}, options);
  sensor::EventModelOptions paper;
  paper.constants.sigma_w = paper.constants.sigma_z = 0;
  EXPECT_EQ(rig.sum_windows(rig.play_cycle().value()), sensor::simulate_events(test_codes(), field, paper).value());
}

TEST(VirtualRig, ARiseSpreadsEventsInTimeAndKeepsTheirSums) {
  RigOptions options;
  options.rise_us = 3000;
  auto sudden = make_rig(quiet(StreamModel::kReferenceAware), still(bands(0.8F)));
  auto slow = make_rig(quiet(StreamModel::kReferenceAware), still(bands(0.8F)), {}, options);
  for (int cycle = 0; cycle < 2; ++cycle) {
    const auto batch = slow.play_cycle().value();
    EXPECT_EQ(sudden.sum_windows(sudden.play_cycle().value()), slow.sum_windows(batch));
    std::map<int64_t, size_t> times;
    for (const int64_t t : batch.events.t) ++times[t];
    EXPECT_GT(times.size(), 50U);
    // a2 begins here; its last events come within its rise.
    const int64_t begin_us = 100000 + cycle * 94736 + 5 * 10592 + 2 * (15592 - 10592);
    const auto after = times.lower_bound(begin_us + 3000);
    EXPECT_TRUE(after == times.end() || after->first >= begin_us + 10592);
  }
}

TEST(VirtualRig, ASceneThatGetsBrighterIsCrossedBetweenItsLightFields) {
  RigOptions options;
  options.schedule = cycles::plain_schedule(4, 10000);
  options.trigger_channel.reset();
  MovingScene scene;
  scene.knot_us = 7000;  // does not fall together with patterns
  scene.at = [](uint64_t knot) {
    LightField field({8, 8, kLevels * kRows, kWidth});
    std::fill(field.data().begin(), field.data().end(), 0.2F + 0.1F * static_cast<float>(knot));
    return Result<LightField>(field);
  };
  auto rig = make_rig(quiet(StreamModel::kReferenceAware, 0.02F), std::move(scene), {}, options);
  const auto batch = rig.play_cycle().value();
  // In a2, from 10 to 20 ms, 9 of 64 cells are open; the scene has 0.2 + t / 70 ms.
  const auto level = [](double t_us) { return std::log(9.0 / 64 * (0.2 + 0.1 * t_us / 7000) + 0.01); };
  size_t count = 0;
  for (size_t i = 0; i < batch.events.size(); ++i) {
    const auto event = batch.events[i];
    // The events of the change to a2 are a microsecond apart.
    if (event.x != 5 || event.y != 7 || event.t <= 110100 || event.t >= 120000) continue;
    const double thresholds = (level(static_cast<double>(event.t - 100000) + 0.5) - std::log(0.01)) / 0.02;
    EXPECT_NEAR(thresholds, std::round(thresholds), 0.01);
    ++count;
  }
  EXPECT_NEAR(static_cast<double>(count), (level(20000) - level(10000)) / 0.02, 1);
}

/// The constants that were fitted to a capture; docs/experiments/camera-fit.md.
capture::SensorProfile fitted_camera() {
  capture::SensorProfile camera;
  camera.event_model = "pixel";
  const std::pair<capture::PixelConstant, float> values[] = {
      {kEps, 0.01F},         {kReceptorRate, 26.5F},  {kAmplifierRate, 279.0F}, {kLeak, 0.0011F},
      {kThresholdOn, 0.46F}, {kThresholdOff, 0.378F}, {kMismatch, 0.116F},      {kMismatchEach, 0.012F},
      {kNoise, 0.0804F},     {kShotNoise, 0.0964F},   {kResetSpan, 1.0F},       {kResetOffset, 0.046F},
      {kDarkOff, 0.0319F},   {kDarkOn, 0.0183F},      {kBlackTime, 0.015592F},  {kLitTime, 0.010592F}};
  for (const auto& [constant, value] : values) camera.pixel[constant] = value;
  camera.transmission = {1.0F, 1.022F, 1.121F};
  return camera;
}

/// Mean, deviation and histogram of a band of an event image.
struct BandCounts {
  double mean = 0.0, deviation = 0.0;
  std::map<int, double> shares;
};

BandCounts counts_of(const capture::EventImages& images, size_t transition, size_t level) {
  BandCounts counts;
  double squares = 0;
  constexpr double kPixels = kRows * kWidth;
  for (const int count : images.image(transition).subspan(level * kRows * kWidth, kRows * kWidth)) {
    counts.mean += count / kPixels;
    squares += count * count / kPixels;
    counts.shares[count] += 1 / kPixels;
  }
  counts.deviation = std::sqrt(squares - counts.mean * counts.mean);
  return counts;
}

/// The same with references held further above black, and thresholds as such a fit finds them.
capture::SensorProfile camera_that_stretches() {
  auto camera = fitted_camera();
  const std::pair<capture::PixelConstant, float> values[] = {
      {kThresholdOn, 0.405F}, {kThresholdOff, 0.312F}, {kMismatch, 0.108F},     {kNoise, 0.0427F},
      {kShotNoise, 0.118F},   {kResetSpan, 1.27F},     {kResetOffset, -0.004F}, {kDarkOff, 0.00765F}};
  for (const auto& [constant, value] : values) camera.pixel[constant] = value;
  return camera;
}

class CountsOfTheRig : public testing::TestWithParam<capture::SensorProfile> {};

/// Compares the counts of a rig's second cycle with those of the closed form, band by band.
void expect_counts_of_closed_form(const capture::SensorProfile& camera, const capture::Codes& codes,
                                  const cycles::Schedule& schedule) {
  const auto field = bands(0.8F);
  RigOptions options;
  options.schedule = schedule;
  auto rig = VirtualRig::create(codes, camera, camera_stream(camera, 1), options, still(field), kLevels * kRows, kWidth)
                 .value();
  ASSERT_TRUE(rig.play_cycle());
  const auto found = rig.sum_windows(rig.play_cycle().value());
  const auto expected = sensor::simulate_pixel_events(codes, field, camera, {.seed = 9, .map_seed = 9}).value();
  ASSERT_EQ(found.count, expected.count);
  // The closed form begins each cycle at rest and compares once a pattern. It draws references after black evenly,
  // which they are not where the scene is so dark that no event comes on the way down.
  constexpr double kMeanTolerance = 0.1, kDeviationTolerance = 0.12, kMostVariation = 0.1;
  for (size_t level = 0; level < kLevels; ++level) {
    for (size_t k = 0; k < found.count; ++k) {
      const BandCounts a = counts_of(found, k, level), b = counts_of(expected, k, level);
      double variation = 0;
      for (int count = -20; count <= 20; ++count) {
        const auto share = [count](const BandCounts& c) { return c.shares.contains(count) ? c.shares.at(count) : 0.0; };
        variation += 0.5 * std::abs(share(a) - share(b));
      }
      EXPECT_NEAR(a.mean, b.mean, kMeanTolerance) << "level " << level << ", image " << k;
      EXPECT_NEAR(a.deviation, b.deviation, kDeviationTolerance) << "level " << level << ", image " << k;
      // The OFF events on the way to black come one by one, where the closed form compares once.
      const double most = k + 1 == 2 * test_codes().num_patterns ? 2 * kMostVariation : kMostVariation;
      EXPECT_LE(variation, most) << "level " << level << ", image " << k;
    }
  }
}

TEST_P(CountsOfTheRig, AreThoseOfTheClosedForm) {
  expect_counts_of_closed_form(GetParam(), test_codes(), cycles::paper_schedule());
}

TEST_P(CountsOfTheRig, OfAWholeCycleAreThoseOfTheClosedForm) {
  expect_counts_of_closed_form(GetParam(), capture::whole_cycle(test_codes()),
                               cycles::with_all_transitions(cycles::paper_schedule()));
}

INSTANTIATE_TEST_SUITE_P(VirtualRig, CountsOfTheRig, testing::Values(fitted_camera(), camera_that_stretches()),
                         [](const auto& camera) {
                           return camera.param.pixel[kResetSpan] > 1.0F ? "SpanAboveOne" : "SpanOne";
                         });

TEST(VirtualRig, KeepsUnequalPixelsFromCycleToCycle) {
  auto camera = fitted_camera();
  camera.pixel[kMismatch] = 0.2F;
  auto rig = make_rig(camera_stream(camera, 1), still(bands(0.8F)), camera);
  // In the brightest band, what a pixel counts in two cycles tells what it counts in the next two.
  constexpr size_t kPixels = kRows * kWidth;
  std::vector<double> sums[2];
  for (auto& sum : sums) {
    sum.resize(kPixels);
    for (int cycle = 0; cycle < 2; ++cycle) {
      const auto images = rig.sum_windows(rig.play_cycle().value());
      for (size_t i = 0; i < kPixels; ++i) sum[i] += images.image(0)[(kLevels - 1) * kPixels + i];
    }
  }
  double mean[2] = {}, product = 0, squares[2] = {};
  for (size_t i = 0; i < kPixels; ++i) {
    for (const size_t k : {0, 1}) mean[k] += sums[k][i] / static_cast<double>(kPixels);
  }
  for (size_t i = 0; i < kPixels; ++i) {
    product += (sums[0][i] - mean[0]) * (sums[1][i] - mean[1]);
    for (const size_t k : {0, 1}) squares[k] += (sums[k][i] - mean[k]) * (sums[k][i] - mean[k]);
  }
  EXPECT_GT(product / std::sqrt(squares[0] * squares[1]), 0.6);
}

TEST(VirtualRig, HoldsBackWhatAReadoutLimitDelaysUntilTheNextCycle) {
  auto stream = quiet(StreamModel::kReferenceAware);
  stream.readout = {.events_per_s = 2e6, .longest_us = 1e6};
  auto rig = make_rig(stream, still(bands(0.8F)));
  int64_t last_us = 0;
  size_t count = 0;
  for (int cycle = 0; cycle < 3; ++cycle) {
    const auto batch = rig.play_cycle().value();
    ASSERT_FALSE(batch.events.empty());
    EXPECT_GE(batch.events.t.front(), last_us);
    EXPECT_TRUE(std::is_sorted(batch.events.t.begin(), batch.events.t.end()));
    last_us = 100000 + (cycle + 1) * cycles::paper_schedule().cycle_us();
    EXPECT_LT(batch.events.t.back(), last_us);
    count += batch.events.size();
  }
  EXPECT_GT(count, 400000U);
  EXPECT_EQ(rig.lost_events(), 0U);
}

TEST(VirtualRig, RefusesSchedulesOfOtherCodes) {
  const auto error_of = [](const RigOptions& options) {
    return VirtualRig::create(test_codes(), {}, {}, options, still(bands(1.0F)), kLevels * kRows, kWidth).error().code;
  };
  RigOptions options;
  options.schedule = cycles::paper_schedule(5);
  EXPECT_EQ(error_of(options), ErrorCode::kInvalidValue);
  options.schedule = cycles::paper_schedule(4);
  options.schedule.patterns[2].name = "b3";
  EXPECT_EQ(error_of(options), ErrorCode::kInvalidValue);
  options.schedule = cycles::paper_schedule(4);
  options.rise_us = 20000;
  EXPECT_EQ(error_of(options), ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::streams
