// SPDX-License-Identifier: MIT
// The operations against their references, against tensors that an implementation in PyTorch computed, and in parts.
#include "e2lf/geometry/operations.h"

#include <gtest/gtest.h>

#include "e2lf/base/threads.h"
#include "e2lf/model/onnx/onnx_export.h"
#include "testing/engine_runs.h"
#include "testing/geometry_reference.h"
#include "testing/test_networks.h"

namespace e2lf::geometry {
namespace {

using engine::conv, engine::largest_difference, engine::reshape, engine::run_engine;
using model::Layer, model::Network;

Layer sweep_layer(const std::string& input) {
  Layer layer = reshape("sweep", GeometryOp::kPlaneSweep, {input});
  layer.kernel = 3;
  layer.attributes = {{"offsets", {-1.5, 0.75, 0.5, -2}}, {"disparities", {-1.2, 0, 0.7}}};
  return layer;
}

Layer render_layer(const std::string& input) {
  Layer layer = reshape("views", GeometryOp::kRenderLayers, {input});
  layer.attributes = {{"disparities", {-1.2, 0.1, 0.7}}, {"rows", {-1.5, 0.5}}, {"columns", {-3.5, 0, 2}}};
  return layer;
}

Layer warp_layer(const std::string& pictures, const std::string& disparity) {
  Layer layer = reshape("moved", GeometryOp::kWarp, {pictures, disparity});
  layer.attributes = {{"offsets", {-1.5, 0.75, 0.5, -2}}, {"disparities", {-1.2, 0.7}}};
  return layer;
}

/// The operations between convolutions, at half the resolution and at the full one.
Network all_operations() {
  add_operations();
  return {3,
          {conv("features", "input", 4, 2, false, "", 2), conv("map", "input", 2, 2, false, "", 2),
           warp_layer("features", "map"), sweep_layer("moved"), conv("weighed", "sweep", 24, 3),
           reshape("planes", model::Op::kPixelShuffle, {"weighed"}, 2), render_layer("planes")}};
}

/// The numbers (31 c + 17 y + 7 x) mod 23, from -1 to 1.
std::vector<float> material(size_t channels, size_t height, size_t width) {
  std::vector<float> values;
  for (size_t i = 0; i < channels * height * width; ++i) {
    const size_t c = i / (height * width), y = i / width % height, x = i % width;
    values.push_back(static_cast<float>((c * 31 + y * 17 + x * 7) % 23) / 11.5F - 1);
  }
  return values;
}

/// A value of the output.
struct Golden {
  size_t channel, y, x;
  double value;
};

/// Programs without this component are told of it.
TEST(GeometryOperations, AreNamedWithTheirComponentWhereTheyAreMissing) {
  for (const engine::Operation& operation : {plane_sweep(), render_layers(), warp()}) {
    const std::string text = model::unknown_operation(operation.model.name, "").text();
    EXPECT_NE(text.find("e2lf::geometry::add_operations()"), std::string::npos) << text;
  }
}

void expect_golden(const Layer& layer, size_t channels, const std::vector<Golden>& golden, double sum) {
  add_operations();
  const std::vector<float> output = run_engine({channels, {layer}}, {}, material(channels, 5, 6), 5, 6);
  for (const Golden& each : golden) {
    EXPECT_NEAR(output[(each.channel * 5 + each.y) * 6 + each.x], each.value, 2e-6) << each.channel;
  }
  double found = 0.0;
  for (const float value : output) found += std::abs(static_cast<double>(value));
  EXPECT_NEAR(found, sum, 1e-4 * sum);
}

TEST(GeometryOperations, SweepEqualsThatOfTheTraining) {
  expect_golden(sweep_layer("input"), 4,
                {{0, 0, 0, 0.001096},
                 {0, 2, 3, -0.018693},
                 {1, 4, 5, -0.040726},
                 {1, 1, 1, -0.03405},
                 {2, 3, 0, 0.008314},
                 {2, 0, 5, 0.001003}},
                1.808789);
}

TEST(GeometryOperations, ViewsOfLayersEqualThoseOfTheTraining) {
  expect_golden(render_layer("input"), 6,
                {{0, 0, 0, -0.532729},
                 {0, 2, 3, -0.147834},
                 {1, 4, 5, 0.027977},
                 {3, 1, 1, 0.31679},
                 {4, 3, 0, -0.329969},
                 {5, 0, 5, 0.372884}},
                49.361237);
}

TEST(GeometryOperations, EqualTheirReferencesForEverySize) {
  const Network network = all_operations();
  const model::Weights weights = engine::random_weights(network, 3);
  for (const auto& [height, width] : std::vector<std::pair<size_t, size_t>>{{2, 2}, {26, 34}, {6, 4100}, {40, 540}}) {
    const auto input = engine::random_values(3 * height * width, 5);
    const auto expected = engine::run_reference(network, weights, input, height, width).value();
    EXPECT_LT(largest_difference(run_engine(network, weights, input, height, width), expected), 1e-4) << width;
    if (!engine::bfloat16_supported()) continue;
    const auto narrow = run_engine(network, weights, input, height, width, engine::Precision::kBfloat16);
    EXPECT_LT(largest_difference(narrow, expected), 0.1) << width;
  }
}

TEST(GeometryOperations, AreBitIdenticalForAnyNumberOfThreadsAndInPanels) {
  const Network network = all_operations();
  const model::Weights weights = engine::random_weights(network, 3);
  const size_t height = 20, width = 2300, part = 600;
  const auto input = engine::random_values(3 * height * width, 5);
  set_num_threads(1);
  const auto one = run_engine(network, weights, input, height, width);  // wider than a panel of the engine
  set_num_threads(3);
  EXPECT_EQ(run_engine(network, weights, input, height, width), one);
  set_num_threads(0);
  std::vector<float> left;
  for (size_t row = 0; row < 3 * height; ++row) {
    left.insert(left.end(), input.begin() + static_cast<ptrdiff_t>(row * width),
                input.begin() + static_cast<ptrdiff_t>(row * width + part));
  }
  const auto alone = run_engine(network, weights, left, height, part);
  for (size_t row = 0; row < 6 * height; ++row) {
    for (size_t x = 0; x < part - 64; ++x) ASSERT_EQ(alone[row * part + x], one[row * width + x]) << row << " " << x;
  }
}

/// A plane at disparity 0.5 that picture p shows at offset_p * 0.5, where a ramp has its closed form.
TEST(GeometryOperations, PicturesOfAPlaneAgreeWhereTheyAreMovedByItsDisparity) {
  add_operations();
  constexpr size_t kSide = 12;
  constexpr double kDisparity = 0.5;
  const std::vector<double> offsets = warp_layer("", "").attributes.at("offsets");
  const auto ramp = [](double y, double x) { return static_cast<float>(0.3 * y - 0.2 * x); };
  std::vector<float> input;
  for (size_t p = 0; p < 2; ++p) {
    for (size_t i = 0; i < kSide * kSide; ++i) {
      const auto y = static_cast<double>(i / kSide), x = static_cast<double>(i % kSide);
      input.push_back(ramp(y - offsets[2 * p] * kDisparity, x - offsets[2 * p + 1] * kDisparity));
    }
  }
  input.insert(input.end(), kSide * kSide, float{kDisparity});
  Layer pictures = conv("pictures", "input", 2, 1, false), map = conv("map", "input", 1, 1, false);
  const model::Weights weights = {
      {"pictures.weight", {1, 0, 0, 0, 1, 0}}, {"pictures.bias", {0, 0}}, {"map.weight", {0, 0, 1}}, {"map.bias", {0}}};
  const auto moved = run_engine({3, {pictures, map, warp_layer("pictures", "map")}}, weights, input, kSide, kSide);
  for (size_t i = 0; i < 2 * kSide * kSide; ++i) {
    const size_t y = i / kSide % kSide, x = i % kSide;
    if (y < 2 || x < 2 || y + 2 >= kSide || x + 2 >= kSide) continue;  // edges are repeated
    EXPECT_NEAR(moved[i], ramp(static_cast<double>(y), static_cast<double>(x)), 1e-5) << y << " " << x;
  }
}

TEST(GeometryOperations, SomeViewsAreThoseOfAll) {
  const Network network = all_operations();
  const auto engine = engine::Engine::create(network, engine::random_weights(network, 3)).value();
  const size_t pixels = 16 * 300;
  const auto input = engine::random_values(3 * pixels, 5);
  std::vector<float> all(6 * pixels), some(6 * pixels, -7);
  ASSERT_TRUE(engine.run(input, 16, 300, all));
  const auto two = engine.with_outputs({1, 5});
  ASSERT_TRUE(two);
  ASSERT_TRUE(two->run(input, 16, 300, some));
  for (size_t i = 0; i < some.size(); ++i) {
    const size_t view = i / pixels;
    ASSERT_EQ(some[i], view == 1 || view == 5 ? all[i] : -7);
  }
}

TEST(GeometryOperations, HaveShapesAndReach) {
  const Network network = all_operations();
  const auto shapes = model::infer_shapes(network).value();
  EXPECT_EQ(shapes[2].channels, 4U);
  EXPECT_EQ(shapes[3].channels, 3U);
  EXPECT_EQ(shapes[6].channels, 6U);
  EXPECT_GT(model::receptive_radius(network), 3U + 2U * (2U + 1U) + 2U * 3U);
  EXPECT_EQ(model::network_from_json(model::to_json(network), "x").value(), network);
  EXPECT_EQ(model::onnx_refusal(network), "");
}

TEST(GeometryOperations, RefuseWhatDoesNotFit) {
  add_operations();
  const auto code = [](const Layer& layer, size_t channels) {
    const auto shapes = model::infer_shapes({channels, {layer}});
    return shapes ? ErrorCode() : shapes.error().code;
  };
  EXPECT_EQ(code(sweep_layer("input"), 5), ErrorCode::kShape);
  EXPECT_EQ(code(render_layer("input"), 5), ErrorCode::kShape);
  EXPECT_EQ(code(warp_layer("input", "input"), 5), ErrorCode::kShape);
  for (Layer layer : {sweep_layer("input"), render_layer("input"), warp_layer("input", "input")}) {
    layer.attributes["disparities"] = {1e9};
    EXPECT_EQ(code(layer, 2), ErrorCode::kInvalidValue) << layer.op;
    layer.attributes.clear();
    EXPECT_EQ(code(layer, 2), ErrorCode::kInvalidValue) << layer.op;
  }
}

}  // namespace
}  // namespace e2lf::geometry
