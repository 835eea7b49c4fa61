// SPDX-License-Identifier: MIT
// Networks that are adapted to patterns, against values that an implementation in PyTorch computed for the same
// weights.
#include "e2lf/geometry/any_patterns.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>

#include "e2lf/geometry/aperture.h"
#include "e2lf/geometry/operations.h"
#include "testing/engine_runs.h"
#include "testing/networks_for_any_patterns.h"

namespace e2lf::geometry {
namespace {

using capture::Codes;
using engine::conv, engine::run_engine;
using namespace for_any_patterns;

struct GoldenPixel {
  size_t channel, y, x;
  double value;
};

void expect_outputs(const Codes& codes, const std::vector<GoldenPixel>& golden, double sum) {
  const auto model = for_patterns(small_model(), codes);
  ASSERT_TRUE(model) << model.error().text();
  EXPECT_EQ(model->codes, codes);
  const std::vector<float> output =
      run_engine(model->network, model->weights, inputs(codes.num_patterns - 1), kSize, kSize);
  for (const GoldenPixel& pixel : golden) {
    EXPECT_NEAR(output[(pixel.channel * kSize + pixel.y) * kSize + pixel.x], pixel.value, 1e-5);
  }
  double found = 0;
  for (const float value : output) found += std::abs(static_cast<double>(value));
  EXPECT_NEAR(found, sum, 1e-4 * sum);
}

TEST(AnyPatterns, AdaptedNetworksEqualThatOfTheTraining) {
  expect_outputs(with_black_and_grey(),
                 {{0, 0, 0, 0.025073},
                  {0, 7, 30, -0.386516},
                  {0, 16, 13, -0.172087},
                  {1, 31, 31, 0.215316},
                  {1, 20, 3, 0.003807},
                  {1, 9, 18, -0.009209}},
                 538.594238);
}

TEST(AnyPatterns, WholeCyclesTakeTransmissionsOfTheirLitPatternsOnly) {
  expect_outputs(capture::whole_cycle(three_boxes()),
                 {{0, 0, 0, 0.210777},
                  {0, 7, 30, -0.082415},
                  {0, 16, 13, 0.634861},
                  {1, 31, 31, -0.033601},
                  {1, 20, 3, -0.232324},
                  {1, 9, 18, -0.399785}},
                 1001.668579);
}

/// Returns a network of views that reads three event images and states no patterns.
model::Model views_of_counts() {
  model::Model views;
  views.name = "views";
  views.num_patterns = 4;
  views.input = {{model::InputKind::kCounts, 0.125F}};
  views.network = {3, {conv("views", "input", 64, 1, false)}};
  for (const auto& weights : model::weight_shapes(views.network)) {
    views.weights[weights.name] = numbered(weights.name, weights.shape);
  }
  return views;
}

TEST(AnyPatterns, GuideViewsAsSoonAsThePatternsAreKnown) {
  model::Model views = views_of_counts();
  views.open_guide = std::make_shared<const model::OpenGuide>(model::OpenGuide{{}, small_model()});
  EXPECT_EQ(model::validate(views, "views").error().code, ErrorCode::kUnsupported);
  Codes others = three_boxes();
  std::swap_ranges(others.pattern(1).begin(), others.pattern(1).end(), others.pattern(2).begin());
  const auto adapted = for_patterns(views, others);
  ASSERT_TRUE(adapted) << adapted.error().text();
  model::Model alone = views;
  alone.open_guide = nullptr;
  alone.codes = others;
  const auto expected = guided(alone, for_patterns(small_model(), others).value(), {});
  ASSERT_TRUE(expected) << expected.error().text();
  EXPECT_EQ(adapted->network, expected->network);
  EXPECT_EQ(adapted->weights, expected->weights);
  EXPECT_EQ(adapted->codes, others);
  // Counts, which the network of disparity does not read, come first.
  EXPECT_EQ(adapted->input.front().kind, model::InputKind::kCounts);
  EXPECT_FALSE(for_own_patterns(views).value().codes);  // not known
  views.codes = three_boxes();
  EXPECT_EQ(for_own_patterns(views)->weights, for_patterns(views, three_boxes())->weights);
  EXPECT_EQ(for_patterns(views, others).error().code, ErrorCode::kInvalidValue);
}

TEST(AnyPatterns, MoveThePicturesThatANetworkForOthersCompares) {
  model::Model views = views_of_counts();
  model::Model fixed = for_patterns(small_model(), three_boxes()).value();
  fixed.any_patterns.clear();
  views.open_guide = std::make_shared<const model::OpenGuide>(model::OpenGuide{{}, fixed});
  Codes corners(4, 8, 8);  // single cells
  corners.pattern(1)[0] = corners.pattern(2)[7] = corners.pattern(3)[63] = 1.0F;
  const auto moved = for_patterns(views, corners);
  ASSERT_TRUE(moved) << moved.error().text();
  const auto sweep = std::ranges::find(moved->network.layers, "guide_sweep", &model::Layer::name);
  ASSERT_NE(sweep, moved->network.layers.end());
  std::vector<double> offsets = {-4, -4, -4, 3, 3, 3};  // from view (4, 4)
  const auto stride = std::ranges::find(fixed.network.layers, "pictures", &model::Layer::name)->stride;
  for (double& offset : offsets) offset /= static_cast<double>(stride);
  EXPECT_EQ(sweep->attributes.at("offsets"), offsets);
  Codes more(5, 8, 8);
  for (size_t p = 1; p < 5; ++p) more.pattern(p)[9 * p] = 1.0F;
  views.num_patterns = 5;
  views.network.input_channels = 4;
  EXPECT_EQ(for_patterns(views, more).error().code, ErrorCode::kShape);
}

TEST(AnyPatterns, AreRefusedByNetworksForTheirOwnPatterns) {
  model::Model model = small_model();
  model.any_patterns.clear();
  EXPECT_EQ(for_patterns(model, three_boxes()).error().code, ErrorCode::kUnsupported);
}

TEST(AnyPatterns, WeightsOfAnotherShapeAreRefused) {
  model::Model model = small_model();
  model.any_patterns["weigh.weight"].shape = {6, 52, 3, 3};
  const auto adapted = for_patterns(model, three_boxes());
  ASSERT_FALSE(adapted);
  EXPECT_EQ(adapted.error().code, ErrorCode::kShape);
}

TEST(AnyPatterns, NeedBlackFirstAndParallax) {
  Codes same(3, 8, 8);
  open_cells(kFirst, 1, same);
  open_cells(kFirst, 2, same);
  EXPECT_EQ(for_patterns(small_model(), same).error().code, ErrorCode::kInvalidValue);
  Codes lit = three_boxes();
  open_cells(kThird, 0, lit);
  EXPECT_EQ(for_patterns(small_model(), lit).error().code, ErrorCode::kInvalidValue);
}

TEST(Aperture, PicturesThatAreLinearInTheViewpointGiveTheirCentreAndSlopes) {
  const Aperture aperture = describe_aperture(three_boxes()).value();
  const double centre = 0.7, slope_y = -0.2, slope_x = 0.4;
  double found[3] = {};
  for (const AperturePicture& picture : aperture.pictures) {
    const double value = centre + slope_y * picture.offset_y + slope_x * picture.offset_x;
    for (size_t i = 0; i < 3; ++i) found[i] += picture.moments[i] * value;
  }
  EXPECT_NEAR(found[0], centre, 0.01);  // the ridge takes little
  EXPECT_NEAR(found[1], slope_y, 0.01);
  EXPECT_NEAR(found[2], slope_x, 0.01);
}

TEST(Aperture, AreasAndCentroidsAreThoseOfThePatterns) {
  const Aperture aperture = describe_aperture(with_black_and_grey()).value();
  ASSERT_EQ(aperture.pictures.size(), 3U);
  const AperturePicture& second = aperture.pictures[1];
  EXPECT_DOUBLE_EQ(second.offset_y, -1.5);
  EXPECT_DOUBLE_EQ(second.offset_x, 1.5);
  EXPECT_NEAR(second.log_area, std::log(16.0 / 8), 1e-12);
  EXPECT_NEAR(second.gain, 8.0 / 16, 1e-12);
  EXPECT_EQ(aperture.pictures[2].transition, 3U);  // black patterns have no picture
}

}  // namespace
}  // namespace e2lf::geometry
