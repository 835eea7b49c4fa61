// SPDX-License-Identifier: MIT
#include "e2lf/compare/view_scan.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "e2lf/model/import_event_video.h"
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
model::VideoModel firenet() {
  const TestFolder folder;
  EXPECT_TRUE(write_safetensors(folder / "c.safetensors", model::firenet_checkpoint(true)));
  return model::import_event_video(folder / "c.safetensors").value();
}

TEST(ViewScan, AStillAndEvenSceneMakesNoEvents) {
  lightfield::LightField scene({8, 8, 16, 16});
  for (float& value : scene.data()) value = 0.5F;
  const ScanResult result = scan_to_light_field(firenet(), scene, {.seed = 1}).value();
  EXPECT_LT(result.events_per_pixel, 0.05);  // noise and leakage of 1.27 s
  EXPECT_DOUBLE_EQ(result.measurement_ms, 1270);
}

TEST(ViewScan, CountsTheStepsOfBrightnessBetweenViews) {
  lightfield::LightField scene({8, 8, 16, 16});
  const size_t view_size = scene.shape().view_size();
  // Views in odd columns are brighter by 4.5 thresholds of 0.3 +- 0.03: along rows each of 7 changes makes 4 events or
  // 5, along columns those from column to column alone.
  for (size_t i = 0; i < scene.data().size(); ++i) {
    scene.data()[i] = i / view_size % 2 == 0 ? 0.2F : 0.2F * std::exp(4.5F * 0.3F);
  }
  const ScanResult result = scan_to_light_field(firenet(), scene, {.seed = 1}).value();
  const double changes = 8 * 7 + 7;
  EXPECT_NEAR(result.events_per_pixel / changes, 4.25, 0.4);
}

TEST(ViewScan, RefusesOtherLightFields) {
  EXPECT_EQ(scan_to_light_field(firenet(), lightfield::LightField({3, 3, 16, 16}), {}).error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::compare
