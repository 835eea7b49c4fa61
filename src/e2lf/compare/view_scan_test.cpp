// SPDX-License-Identifier: MIT
#include "e2lf/compare/view_scan.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "e2lf/video/import_event_video.h"
#include "testing/event_video_checkpoints.h"
#include "testing/test_files.h"

namespace e2lf::compare {
namespace {

TEST(ScanOrder, GoesTwiceOverAllViewsInStepsOfOne) {
  const std::vector<size_t> order = scan_order();
  ASSERT_EQ(order.size(), 127U);
  EXPECT_EQ(std::set<size_t>(order.begin(), order.begin() + 64).size(), 64U);
  EXPECT_EQ(std::set<size_t>(order.end() - 64, order.end()).size(), 64U);
  for (size_t i = 1; i < order.size(); ++i) {
    const auto row = [&](size_t k) { return static_cast<int>(order[k] / 8); };
    const auto column = [&](size_t k) { return static_cast<int>(order[k] % 8); };
    EXPECT_EQ(std::abs(row(i) - row(i - 1)) + std::abs(column(i) - column(i - 1)), 1) << i;
  }
  EXPECT_EQ(order.front(), 0U);
  EXPECT_EQ(order[63], 56U);
  EXPECT_EQ(order[64], 48U);
}

/// With random weights.
video::VideoModel firenet() {
  const TestFolder folder;
  EXPECT_TRUE(write_safetensors(folder / "c.safetensors", video::firenet_checkpoint(true)));
  return video::import_event_video(folder / "c.safetensors").value();
}

TEST(ViewScan, AStillAndEvenSceneMakesNoEvents) {
  lightfield::LightField scene({8, 8, 16, 16});
  for (float& value : scene.data()) value = 0.5F;
  const ScanResult result = scan_to_light_field(firenet(), scene, {.seed = 1}).value();
  EXPECT_LT(result.events_per_pixel, 0.05);  // noise and leakage of 1.27 s
  EXPECT_DOUBLE_EQ(result.measurement_ms, 1270);
}

/// Events per change of a pixel whose log intensity goes up and down by 1.35, with thresholds of its own for both
/// signs: what is left after an event of one sign is missing at the next of the other.
double mean_events_per_change(size_t changes) {
  std::mt19937 generator(1);
  std::normal_distribution<double> threshold(0.3, 0.03);
  constexpr size_t kPixels = 20000;
  double events = 0;
  for (size_t pixel = 0; pixel < kPixels; ++pixel) {
    const double on = threshold(generator), off = threshold(generator);
    double reference = 0;
    for (size_t i = 0; i < changes; ++i) {
      const double change = (i % 2 == 0 ? 1.35 : 0.0) - reference;
      const double size = change > 0 ? on : off, count = std::trunc(change / size);
      reference += count * size;
      events += std::abs(count);
    }
  }
  return events / static_cast<double>(kPixels * changes);
}

TEST(ViewScan, CountsTheStepsOfBrightnessBetweenViews) {
  lightfield::LightField scene({8, 8, 32, 32});
  const size_t view_size = scene.shape().view_size();
  for (size_t i = 0; i < scene.data().size(); ++i) {
    scene.data()[i] = i / view_size % 2 == 0 ? 0.2F : 0.2F * std::exp(1.35F);
  }
  const ScanResult result = scan_to_light_field(firenet(), scene, {.seed = 1}).value();
  // Views in odd columns are brighter: along rows each of 7 changes counts, along columns those from one to the next.
  constexpr size_t kChanges = 8 * 7 + 7;
  EXPECT_NEAR(result.events_per_pixel / kChanges, mean_events_per_change(kChanges), 0.1);
}

TEST(ViewScan, RefusesOtherLightFields) {
  EXPECT_EQ(scan_to_light_field(firenet(), lightfield::LightField({3, 3, 16, 16}), {}).error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::compare
