// SPDX-License-Identifier: MIT
// Depth from events by a network whose answer is known.
#include "e2lf/pipeline/event_depth.h"

#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/geometry/operations.h"

namespace e2lf::pipeline {
namespace {

/// A network whose disparity is half the first count plus 1, with a scale of 0.07 px.
model::Model known_network() {
  model::Model model;
  model.name = "known";
  model.num_patterns = 4;
  model.input = {{model::InputKind::kCounts, 0.125F}};
  model.network = {3, {{.name = "out", .inputs = {"input"}, .out_channels = 2}}};
  model.weights = {{"out.weight", {4, 0, 0, 0, 0, 0}}, {"out.bias", {1, std::log(0.07F)}}};
  return model;
}

capture::EventImages counts() {
  capture::EventImages images(3, 5, 6);
  for (size_t i = 0; i < images.values.size(); ++i) images.values[i] = static_cast<int16_t>(i % 7) - 3;
  return images;
}

OpenedMethod opened() {
  return open_method({.algorithm = Algorithm::kDepth, .model = known_network()}).value();
}

TEST(DepthOfEvents, IsTheLocationWithTheConfidenceOfTheScale) {
  const auto found = depth_of_events(opened(), counts());
  ASSERT_TRUE(found) << found.error().text();
  ASSERT_EQ(found->map.disparity.height, 5U);
  for (size_t i = 0; i < 30; ++i) {
    EXPECT_FLOAT_EQ(found->map.disparity.pixels[i], 1 + 0.5F * static_cast<float>(static_cast<int>(i % 7) - 3));
    EXPECT_NEAR(found->map.confidence.pixels[i], 0.5, 1e-5);
  }
  EXPECT_EQ(found->map.view.y, 4U);
  EXPECT_EQ(found->picture.pixels.size(), 30U);
}

TEST(DepthOfEvents, ChangesItsSignWithTurnedViews) {
  const OpenedMethod method = opened();
  const auto upright = depth_of_events(method, counts()),
             turned = depth_of_events(method, counts(), 1, capture::kTurned);
  ASSERT_TRUE(upright && turned);
  EXPECT_EQ(turned->map.disparity.pixels[3], -upright->map.disparity.pixels[3]);
  // The view in row 4 of the turned 8x8 views is in row 3 of the upright ones.
  EXPECT_EQ(turned->map.view.y, 3U);
  EXPECT_EQ(turned->map.view.x, 3U);
  EXPECT_EQ(depth_of_events(method, counts(), 1, {.flip_x = true}).error().code, ErrorCode::kUnsupported);
}

TEST(DepthOfEvents, DisparitiesAtTheEndOfTheRangeAreFound) {
  model::Model model = known_network();
  depth::DisparityMap map;
  map.disparity = lightfield::Image(4, 1, 1);
  map.disparity.pixels = {-3.3F, 0, 3.1F, 4};
  EXPECT_FALSE(range_finding(model, map));
  model.network.layers.push_back({.name = "sweep", .op = geometry::GeometryOp::kPlaneSweep, .inputs = {}});
  for (int i = -17; i <= 17; ++i) model.network.layers.back().attributes["disparities"].push_back(0.2 * i);
  const auto finding = range_finding(model, map);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->code, "disparity-range");
  EXPECT_EQ(finding->figures["share"], 0.5);  // -3.3 and 4, as 3.4 - 0.2 is the limit
  map.disparity.pixels = {-3.1F, 0, 3.1F, 2};
  EXPECT_FALSE(range_finding(model, map));
}

TEST(DepthOfEvents, MapsOfHardlyAnyConfidenceAreFound) {
  depth::DisparityMap map;
  map.confidence = lightfield::Image(100, 1, 1);
  std::fill_n(map.confidence.pixels.begin(), 9, 0.9F);
  const auto finding = confidence_finding(map);
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->code, "disparity-uncertain");
  EXPECT_EQ(finding->figures["share"], 0.09);
  map.confidence.pixels[50] = depth::kLeastConfidence;
  EXPECT_FALSE(confidence_finding(map));
}

TEST(DepthOfEvents, NetworksForTheOtherOutputAreRefused) {
  EXPECT_EQ(open_method({.model = known_network()}).error().code, ErrorCode::kUnsupported);
  model::Model of_views = known_network();
  of_views.network.layers[0].out_channels = 64;
  of_views.weights = {{"out.weight", std::vector<float>(64 * 3)}, {"out.bias", std::vector<float>(64)}};
  EXPECT_EQ(open_method({.algorithm = Algorithm::kDepth, .model = of_views}).error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace e2lf::pipeline
