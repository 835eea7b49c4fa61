// SPDX-License-Identifier: MIT
// Networks that are adapted to patterns, against values that bench/geometry/networks.py computed for the same weights.
#include "e2lf/geometry/any_patterns.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "e2lf/geometry/aperture.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/model/composition.h"
#include "testing/engine_runs.h"
#include "testing/test_networks.h"

namespace e2lf::geometry {
namespace {

using capture::Codes;
using engine::conv, engine::reshape, engine::run_engine;
using model::Layer;

constexpr size_t kSize = 32;  // height and width of the images, px

struct Box {
  size_t top, bottom, left, right;
  float value = 1;
};

void open_cells(const Box& box, size_t n, Codes& codes) {
  for (size_t y = box.top; y < box.bottom; ++y) {
    for (size_t x = box.left; x < box.right; ++x) codes.pattern(n)[y * 8 + x] = box.value;
  }
}

constexpr Box kFirst = {1, 4, 1, 4}, kSecond = {1, 5, 4, 8}, kThird = {5, 8, 3, 6};

/// Black, two boxes, black again, and a pattern of two grey boxes.
Codes with_black_and_grey() {
  Codes codes(5, 8, 8);
  open_cells(kFirst, 1, codes);
  open_cells(kSecond, 2, codes);
  open_cells({1, 4, 1, 4, 0.5F}, 4, codes);
  open_cells({5, 7, 2, 4, 0.25F}, 4, codes);
  return codes;
}

Codes three_boxes() {
  Codes codes(4, 8, 8);
  open_cells(kFirst, 1, codes);
  open_cells(kSecond, 2, codes);
  open_cells(kThird, 3, codes);
  return codes;
}

Layer transposed(const std::string& name, const std::string& input, size_t out_channels) {
  Layer layer = conv(name, input, out_channels, 2, false, "", 2);
  layer.op = Op::kConvTransposed;
  return layer;
}

/// The layers of e2lf-depth with one level of 4 and 6 channels.
model::Network small_network(size_t input_channels) {
  Layer sweep = reshape("sweep", Op::kPlaneSweep, {"features"});
  sweep.kernel = 7;
  for (int i = -17; i <= 17; ++i) sweep.attributes["disparities"].push_back(0.2 * i);
  sweep.attributes["offsets"] = {0, 0, 0, 0, 0, 0};
  return {input_channels,
          {conv("stem", "input", 4, 2, true, "", 2), conv("start", "stem", 4, 3, false),
           conv("pictures", "input", 3, 4, false, "", 4), conv("features", "pictures", 12, 5, false), sweep,
           conv("down0_0a", "start", 4, 3, true), conv("down0_0b", "down0_0a", 4, 3, false, "start"),
           conv("down0_half", "down0_0b", 6, 2, false, "", 2),
           reshape("evidence", Op::kConcat, {"down0_half", "sweep", "features"}),
           conv("weigh", "evidence", 6, 3, false, "down0_half"), conv("middle_0a", "weigh", 6, 3, true),
           conv("middle_0b", "middle_0a", 6, 3, false, "weigh"), transposed("up0_double", "middle_0b", 4),
           reshape("up0_join", Op::kAdd, {"up0_double", "down0_0b"}), conv("up0_0a", "up0_join", 4, 3, true),
           conv("up0_0b", "up0_0a", 4, 3, false, "up0_join"), conv("head", "up0_0b", 8, 3, false),
           reshape("disparity", Op::kPixelShuffle, {"head"}, 2)}};
}

/// The numbers (29 i + 13 n) mod 31, from -1 to 1, over the square root of the number of weights of an output.
std::vector<float> numbered(const std::string& name, const std::vector<size_t>& shape) {
  size_t number = 1;
  for (const size_t extent : shape) number *= extent;
  const size_t outputs = name == "up0_double.weight" ? number / shape[0] : shape[0];
  const double scale = std::sqrt(name.ends_with(".bias") ? 16.0 : static_cast<double>(number / outputs));
  std::vector<float> values;
  for (size_t i = 0; i < number; ++i) {
    values.push_back(static_cast<float>((static_cast<double>((29 * i + 13 * number) % 31) / 15.5 - 1) / scale));
  }
  return values;
}

model::Model small_model() {
  add_operations();
  model::Model model;
  model.name = "small";
  model.num_patterns = 4;
  model.codes = three_boxes();
  model.camera.emplace();
  model.input = {{model::InputKind::kCumulative, 0.125F},
                 {model::InputKind::kLevel, 0.125F},
                 {model::InputKind::kIntensity, 4.0F},
                 {model::InputKind::kCamera, 1.0F}};
  model.network = small_network(model::num_input_channels(model.input, 4));
  for (const auto& weights : model::weight_shapes(model.network)) {
    model.weights[weights.name] = numbered(weights.name, weights.shape);
  }
  const std::pair<std::string, std::vector<size_t>> shared[] = {
      {"stem.weight", {4, 48, 2, 2}},     {"stem.bias", {4}},
      {"pictures.weight", {3, 45, 4, 4}}, {"pictures.bias", {3}},
      {"features.weight", {12, 3, 5, 5}}, {"features.bias", {12}},
      {"weigh.weight", {6, 65, 3, 3}}};
  for (const auto& [name, shape] : shared) model.any_patterns[name] = {shape, numbered(name, shape)};
  return model;
}

/// Inputs for `transitions` event images: the numbers (31 c + 17 y + 7 x) mod 23 from -1 to 1, and conditions.
std::vector<float> inputs(size_t transitions) {
  std::vector<float> values;
  for (size_t c = 0; c < 3 * transitions; ++c) {
    for (size_t i = 0; i < kSize * kSize; ++i) {
      values.push_back(static_cast<float>((c * 31 + i / kSize * 17 + i % kSize * 7) % 23) / 11.5F - 1);
    }
  }
  const auto add_plane = [&](double value) { values.insert(values.end(), kSize * kSize, static_cast<float>(value)); };
  for (size_t c = 0; c < 15; ++c) add_plane((static_cast<double>(7 * c % 5) - 2) * 0.2);
  add_plane(0.25);  // two cycles
  for (size_t k = 1; k < transitions; ++k) add_plane(0.1 * static_cast<double>(k));
  return values;
}

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

TEST(AnyPatterns, GuideViewsAsSoonAsThePatternsAreKnown) {
  model::Model views;
  views.name = "views";
  views.num_patterns = 4;
  views.input = {{model::InputKind::kCounts, 0.125F}};
  views.network = {3, {conv("views", "input", 64, 1, false)}};
  for (const auto& weights : model::weight_shapes(views.network)) {
    views.weights[weights.name] = numbered(weights.name, weights.shape);
  }
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
