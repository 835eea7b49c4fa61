// SPDX-License-Identifier: MIT
#include "e2lf/recon/input.h"

#include <gtest/gtest.h>
#include <limits>

#include "e2lf/base/threads.h"

namespace e2lf::recon {
namespace {

/// Returns what network_input() computes.
Result<InputPlanes> input_of(const capture::MeasurementView& measurement, std::span<const model::InputGroup> groups,
                             const InputConditions& conditions, size_t size_multiple = 1) {
  InputPlanes planes;
  E2LF_RETURN_IF_ERROR(network_input(measurement, groups, conditions, size_multiple, planes));
  return planes;
}

using model::InputKind;

/// One pixel with the given counts.
capture::EventImages pixel(const std::vector<int16_t>& counts) {
  capture::EventImages images(counts.size(), 1, 1);
  images.values = counts;
  return images;
}

std::vector<float> values(const capture::EventImages& images, const std::vector<model::InputGroup>& groups,
                          const capture::SensorConstants& constants = {}) {
  const auto planes = input_of(images, groups, {.constants = constants});
  EXPECT_TRUE(planes);
  return planes ? planes->values : std::vector<float>();
}

TEST(NetworkInput, GroupsFollowOneAnother) {
  const auto images = pixel({2, 0, -3});
  const std::vector<model::InputGroup> groups = {{InputKind::kCumulative, 0.25F}, {InputKind::kCounts, 0.125F}};
  EXPECT_EQ(values(images, groups), (std::vector<float>{0.5F, 0.5F, -0.25F, 0.25F, 0, -0.375F}));
}

TEST(NetworkInput, IntensityAddsHalfAThresholdTowardTheLastChangeAndEndsAtOne) {
  const capture::SensorConstants constants{.eps = 1.0F / 64, .tau = 0.25F};
  const auto intensity = [](double level) {
    return static_cast<float>(4 * std::min(std::expm1(0.25 * level) / 64, 1.0));
  };
  const auto got = values(pixel({0, 3, 0, -1, 200}), {{InputKind::kIntensity, 4.0F}}, constants);
  const std::vector<float> expected = {0, intensity(3.5), intensity(3.5), intensity(1.5), intensity(202.5)};
  ASSERT_EQ(got.size(), expected.size());
  for (size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], expected[i], 1e-6F * (1 + expected[i])) << i;
}

TEST(NetworkInput, DamagedCountsStayFinite) {
  const int16_t most = std::numeric_limits<int16_t>::max(), least = std::numeric_limits<int16_t>::min();
  for (const float value : values(pixel({most, most, least}), {{InputKind::kIntensity, 1.0F}})) {
    EXPECT_TRUE(std::isfinite(value));
  }
}

TEST(NetworkInput, ImagesFollowCountsAndAreExtendedAlike) {
  capture::Measurement measured;
  measured.kind = capture::MeasurementKind::kHybrid;
  measured.events = capture::EventImages(1, 1, 3);
  measured.events.values = {4, 8, 16};
  measured.images = capture::CodedIntensities(1, 1, 3);
  measured.images.values = {0.5F, 1.0F, 2.0F};
  const std::vector<model::InputGroup> groups = {{InputKind::kImageSum, 2.0F}, {InputKind::kCounts, 0.25F}};
  const auto planes = input_of(measured, groups, {}, 2).value();
  EXPECT_EQ(planes.values, (std::vector<float>{1, 2, 4, 4, 1, 2, 4, 4, 1, 2, 4, 4, 1, 2, 4, 4}));
}

TEST(NetworkInput, RowsAreContinuedByTheirMirrorImage) {
  const capture::EventImages images = [] {
    capture::EventImages row(1, 1, 3);
    row.values = {1, 2, 3};
    return row;
  }();
  const auto planes = input_of(images, std::vector<model::InputGroup>{{InputKind::kCounts, 1}}, {}, 8).value();
  const std::vector<float> row = {1, 2, 3, 3, 2, 1, 1, 2};
  for (size_t i = 0; i < planes.values.size(); ++i) EXPECT_EQ(planes.values[i], row[i % 8]) << i;
}

TEST(NetworkInput, LensesAreJoinedInStraightLines) {
  capture::Measurement measured;
  measured.kind = capture::MeasurementKind::kLensArray;
  measured.images = capture::CodedIntensities(1, 16, 32);
  for (size_t i = 0; i < measured.images.values.size(); ++i) {
    const size_t y = i / 32, x = i % 32;
    measured.images.values[i] = static_cast<float>(y % 8 * 8 + x % 8) / 64 + 0.5F * static_cast<float>(x / 8);
  }
  const auto planes = input_of(measured, std::vector<model::InputGroup>{{InputKind::kLensArray, 2.0F}}, {}).value();
  ASSERT_EQ(planes.count, 64U);
  const auto at = [&](size_t view, size_t y, size_t x) { return planes.values[(view * 16 + y) * 32 + x]; };
  EXPECT_NEAR(at(9, 5, 0), 2 * 9 / 64.0, 1e-6);  // before the first centre
  EXPECT_NEAR(at(9, 5, 15), 2 * (9 / 64.0 + 0.5 * (15.5 / 8 - 0.5)), 1e-6);
}

TEST(NetworkInput, CameraTraitsFillPlanesOfTheirOwn) {
  capture::EventImages images(2, 3, 2);
  images.values[0] = 5;
  const std::vector<model::InputGroup> groups = {
      {InputKind::kCounts, 1.0F}, {InputKind::kCamera, 2.0F}, {InputKind::kCumulative, 1.0F}};
  const std::vector<float> conditioning = {0.5F, -1.0F, 3.0F};
  const auto planes = input_of(images, groups, {.conditioning = conditioning});
  ASSERT_TRUE(planes);
  ASSERT_EQ(planes->count, 7U);
  EXPECT_EQ(planes->values[0], 5.0F);
  for (size_t trait = 0; trait < conditioning.size(); ++trait) {
    for (size_t i = 0; i < 6; ++i) EXPECT_EQ(planes->values[(2 + trait) * 6 + i], 2.0F * conditioning[trait]);
  }
  EXPECT_EQ(planes->values[5 * 6], 5.0F);
  EXPECT_EQ(planes->values[6 * 6], 5.0F);
}

TEST(NetworkInput, SumsOverCyclesBecomeMeans) {
  capture::EventImages sums(1, 1, 1);
  sums.values[0] = 5;
  const std::vector<model::InputGroup> groups = {
      {InputKind::kCounts, 1.0F}, {InputKind::kCumulative, 2.0F}, {InputKind::kIntensity, 1.0F}};
  const auto planes = input_of(sums, groups, {.constants = {.eps = 0.01F, .tau = 0.3F}, .cycles = 4});
  ASSERT_TRUE(planes);
  EXPECT_FLOAT_EQ(planes->values[0], 1.25F);
  EXPECT_FLOAT_EQ(planes->values[1], 2.5F);
  EXPECT_NEAR(planes->values[2], 0.01 * std::expm1(0.3 * 1.75), 1e-7);
}

TEST(NetworkInput, LevelAddsHalfAThresholdTowardTheLastChange) {
  const std::vector<model::InputGroup> groups = {{InputKind::kLevel, 2.0F}};
  EXPECT_EQ(values(pixel({0, 3, 0, -1}), groups), (std::vector<float>{0, 7, 7, 3}));
  const auto mean = input_of(pixel({2, -1}), groups, {.cycles = 4}).value();
  EXPECT_EQ(mean.values, (std::vector<float>{2 * (0.5F + 0.5F), 2 * (0.25F - 0.5F)}));
}

TEST(NetworkInput, PaddingMirrorsTheLastRowsAndColumns) {
  capture::EventImages images(1, 2, 3);
  images.values = {1, 2, 3, 4, 5, 6};
  const auto planes = input_of(images, std::vector<model::InputGroup>{{InputKind::kCounts, 1.0F}}, {}, 4);
  ASSERT_TRUE(planes);
  EXPECT_EQ(planes->height, 4U);
  EXPECT_EQ(planes->width, 4U);
  EXPECT_EQ(planes->values, (std::vector<float>{1, 2, 3, 3, 4, 5, 6, 6, 4, 5, 6, 6, 1, 2, 3, 3}));
}

TEST(NetworkInput, IsTheSameForAnyThreadCount) {
  capture::EventImages images(3, 37, 29);
  for (size_t i = 0; i < images.values.size(); ++i) images.values[i] = static_cast<int16_t>(i * 7 % 19) - 9;
  const std::vector<model::InputGroup> groups = {
      {InputKind::kCounts, 1}, {InputKind::kCumulative, 1}, {InputKind::kIntensity, 1}};
  set_num_threads(1);
  const auto expected = values(images, groups);
  set_num_threads(3);
  EXPECT_EQ(values(images, groups), expected);
  set_num_threads(0);
}

TEST(NetworkInput, IntensityNeedsPositiveConstants) {
  const capture::SensorConstants no_threshold{.tau = 0};
  const auto planes =
      input_of(pixel({1}), std::vector<model::InputGroup>{{InputKind::kIntensity, 1}}, {.constants = no_threshold});
  ASSERT_FALSE(planes);
  EXPECT_EQ(planes.error().code, ErrorCode::kInvalidValue);
}

TEST(NetworkInput, TakesTheMeansAndTheNumberOfCyclesOfEachPixelFromFusedCycles) {
  capture::Measurement measurement(capture::EventImages(1, 1, 3));
  measurement.events.values = {9, 9, 9};
  measurement.fused.counts = capture::EventImages(1, 1, 3);
  measurement.fused.counts.values = {64, 160, -32};  // 1, 2.5 and -0.5 events
  measurement.fused.cycles = Planes<float>(1, 1, 3);
  measurement.fused.cycles.values = {1, 4, 2};
  const std::vector<model::InputGroup> groups = {{model::InputKind::kCounts, 2.0F}, {model::InputKind::kCamera, 1.0F}};
  InputConditions conditions;
  conditions.conditioning.assign(capture::kNumFixedConditions, 0.5F);
  InputPlanes planes;
  ASSERT_TRUE(network_input(measurement, groups, conditions, 4, planes));
  ASSERT_EQ(planes.width, 4U);
  const auto row = [&](size_t channel) {
    const auto image = planes.image(channel).first(4);
    return std::vector<float>(image.begin(), image.end());
  };
  EXPECT_EQ(row(0), (std::vector<float>{2, 5, -1, -1}));  // the last one is a mirror image
  EXPECT_EQ(row(1), (std::vector<float>{0.5, 0.5, 0.5, 0.5}));
  EXPECT_EQ(row(1 + capture::kCyclesCondition), (std::vector<float>{0, 0.5, 0.25, 0.25}));
}

}  // namespace
}  // namespace e2lf::recon
