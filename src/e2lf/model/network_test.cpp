// SPDX-License-Identifier: MIT
#include "e2lf/model/network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf::model {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Layer layer(const std::string& name, const char* op, std::vector<std::string> inputs) {
  Layer result;
  result.name = name;
  result.op = op;
  result.inputs = std::move(inputs);
  return result;
}

Layer conv(const std::string& name, const std::string& input, size_t out_channels, size_t kernel, size_t stride = 1) {
  Layer result = layer(name, Op::kConv, {input});
  result.out_channels = out_channels;
  result.kernel = kernel;
  result.stride = stride;
  return result;
}

Layer strided(const std::string& name, const char* op, const std::string& input, size_t stride) {
  Layer result = layer(name, op, {input});
  result.stride = stride;
  return result;
}

/// 3 channels, unshuffled by 2, a branch at scale 4 and back, joined, shuffled to one channel per pixel.
Network two_scales() {
  Network network;
  network.input_channels = 3;
  network.layers = {strided("down", Op::kPixelUnshuffle, "input", 2), conv("a", "down", 8, 3), conv("b", "a", 16, 2, 2),
                    conv("c", "b", 16, 3)};
  Layer up = conv("up", "c", 8, 2, 2);
  up.op = Op::kConvTransposed;
  network.layers.push_back(up);
  network.layers.push_back(layer("cat", Op::kConcat, {"up", "a"}));
  network.layers.push_back(conv("d", "cat", 4, 1));
  network.layers.push_back(strided("out", Op::kPixelShuffle, "d", 2));
  return network;
}

Error shapes_error(const Network& network) {
  const auto shapes = infer_shapes(network);
  EXPECT_FALSE(shapes.ok());
  return shapes.ok() ? Error{} : shapes.error();
}

Error error_with(Layer last) {
  Network network = two_scales();
  network.layers.push_back(std::move(last));
  return shapes_error(network);
}

TEST(RecNet, HasTheFiguresOfThePapersNetwork) {
  const Network network = recnet(3);
  EXPECT_EQ(network.layers.size(), 23U);
  EXPECT_EQ(num_parameters(network), 948352U);
  EXPECT_EQ(macs_per_pixel(network), 946880.0);
  EXPECT_EQ(receptive_radius(network), 26U);
  EXPECT_EQ(size_multiple(network), 1U);
}

TEST(RecNet, TakesOtherSizes) {
  const auto shapes = infer_shapes(recnet(5, 25, 16));
  ASSERT_TRUE(shapes.ok());
  EXPECT_EQ(shapes->front().channels, 16U);
  EXPECT_EQ(shapes->back().channels, 25U);
}

TEST(InferShapes, FollowsEveryOperation) {
  const auto shapes = infer_shapes(two_scales());
  ASSERT_TRUE(shapes.ok()) << shapes.error().text();
  std::vector<std::pair<size_t, size_t>> found;
  for (const LayerShape& shape : *shapes) found.emplace_back(shape.channels, shape.scale);
  using Shape = std::pair<size_t, size_t>;
  EXPECT_THAT(found, ElementsAre(Shape{12, 2}, Shape{8, 2}, Shape{16, 4}, Shape{16, 4}, Shape{8, 2}, Shape{16, 2},
                                 Shape{4, 2}, Shape{1, 1}));
}

TEST(InferShapes, UpsampleAndAdd) {
  Network network;
  network.input_channels = 2;
  network.layers = {conv("a", "input", 2, 3, 3), strided("b", Op::kUpsample, "a", 3),
                    layer("c", Op::kAdd, {"b", "input"})};
  const auto shapes = infer_shapes(network);
  ASSERT_TRUE(shapes.ok()) << shapes.error().text();
  EXPECT_EQ(shapes->back().channels, 2U);
  EXPECT_EQ(shapes->back().scale, 1U);
  EXPECT_EQ(size_multiple(network), 3U);
}

TEST(InferShapes, RefusesNamesThatAreTakenOrUnknown) {
  EXPECT_EQ(error_with(conv("a", "out", 1, 1)).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_with(conv("a", "out", 1, 1)).location, "layer \"a\"");
  EXPECT_EQ(error_with(conv("input", "out", 1, 1)).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_with(conv("", "out", 1, 1)).code, ErrorCode::kInvalidValue);
  const Error unknown = error_with(conv("x", "dwon", 1, 1));
  EXPECT_EQ(unknown.code, ErrorCode::kInvalidValue);
  EXPECT_THAT(unknown.message, HasSubstr("down"));
  EXPECT_EQ(error_with(conv("x", "x", 1, 1)).code, ErrorCode::kInvalidValue);
}

TEST(InferShapes, RefusesKernelsAndStridesThatDoNotFit) {
  for (const Layer& bad :
       {conv("x", "out", 1, 2), conv("x", "out", 1, 4, 2), conv("x", "out", 1, 3, 4), conv("x", "out", 1, 0),
        conv("x", "out", 1, 129), conv("x", "out", 1, 1, 0), conv("x", "out", 0, 1), conv("x", "out", 70000, 1),
        strided("x", Op::kPixelUnshuffle, "out", 2000), strided("x", Op::kPixelUnshuffle, "out", ~size_t{0})}) {
    EXPECT_EQ(error_with(bad).code, ErrorCode::kInvalidValue);
  }
  Layer transposed = conv("x", "d", 1, 3, 2);
  transposed.op = Op::kConvTransposed;
  EXPECT_EQ(error_with(transposed).code, ErrorCode::kInvalidValue);
}

TEST(InferShapes, RefusesShapesThatDoNotFit) {
  EXPECT_EQ(error_with(strided("x", Op::kUpsample, "out", 2)).code, ErrorCode::kShape);
  EXPECT_EQ(error_with(strided("x", Op::kPixelShuffle, "out", 2)).code, ErrorCode::kShape);
  EXPECT_EQ(error_with(layer("x", Op::kAdd, {"up", "cat"})).code, ErrorCode::kShape);
  EXPECT_EQ(error_with(layer("x", Op::kConcat, {"up", "c"})).code, ErrorCode::kShape);
  Layer residual = conv("x", "d", 8, 1);
  residual.residual = "d";
  EXPECT_EQ(error_with(residual).code, ErrorCode::kShape);
  residual.residual = "none";
  EXPECT_EQ(error_with(residual).code, ErrorCode::kInvalidValue);
}

TEST(InferShapes, RefusesWrongNumbersOfInputsAndEmptyNetworks) {
  EXPECT_EQ(error_with(layer("x", Op::kAdd, {"out"})).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_with(layer("x", Op::kUpsample, {"d", "d"})).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_with(layer("x", Op::kConv, {})).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(shapes_error(Network()).code, ErrorCode::kInvalidValue);
  Network empty;
  empty.input_channels = 3;
  EXPECT_EQ(shapes_error(empty).code, ErrorCode::kInvalidValue);
}

TEST(InferShapes, RefusesScalesWithoutASmallCommonMultiple) {
  Network network;
  network.input_channels = 1;
  for (const size_t stride : {31, 29, 23}) {
    network.layers.push_back(conv("s" + std::to_string(stride), "input", 1, stride, stride));
  }
  EXPECT_EQ(shapes_error(network).code, ErrorCode::kInvalidValue);
}

TEST(NetworkCost, CountsEveryScale) {
  const Network network = two_scales();
  EXPECT_EQ(size_multiple(network), 4U);
  // Weights and biases of a, b, c, up and d.
  const size_t a = 8 * 12 * 9, b = 16 * 8 * 4, c = 16 * 16 * 9, up = 16 * 8 * 4, d = 4 * 16;
  EXPECT_EQ(num_parameters(network), a + 8 + b + 16 + c + 16 + up + 8 + d + 4);
  // Pixels of half and quarter resolution are 1/4 and 1/16 of the input's; the transposed one works at a quarter.
  EXPECT_DOUBLE_EQ(macs_per_pixel(network), (a + d) / 4.0 + (b + c + up) / 16.0);
}

TEST(NetworkCost, WeightShapesAreThoseOfTorch) {
  const auto shapes = weight_shapes(two_scales());
  ASSERT_EQ(shapes.size(), 10U);
  EXPECT_EQ(shapes[0].name, "a.weight");
  EXPECT_THAT(shapes[0].shape, ElementsAre(8, 12, 3, 3));
  EXPECT_EQ(shapes[6].name, "up.weight");
  EXPECT_THAT(shapes[6].shape, ElementsAre(16, 8, 2, 2));
  EXPECT_THAT(shapes[7].shape, ElementsAre(8));
}

TEST(NetworkCost, ReceptiveRadiusGrowsWithTheScale) {
  // a: 1 pixel at scale 2 = 2; c: 1 at scale 4 = 4; the edges of blocks: 2 (up) and 1 (out).
  EXPECT_EQ(receptive_radius(two_scales()), 2U + 4U + 2U + 1U);
}

TEST(NetworkJson, RoundTrips) {
  for (const Network& network : {two_scales(), recnet(3)}) {
    const auto read = network_from_json(to_json(network), "x");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(*read, network);
  }
}

TEST(NetworkJson, NamesTheKnownTypesAndOperations) {
  const Error type = network_from_json(Json::parse(R"({"type": "transformer", "heads": 8})"), "m: $.network").error();
  EXPECT_EQ(type.code, ErrorCode::kUnsupported);
  EXPECT_EQ(type.location, "m: $.network.type");
  EXPECT_THAT(type.message, HasSubstr("conv-graph"));
  Json json = to_json(two_scales());
  json["layers"][2]["op"] = "look-around";
  const Error op = network_from_json(json, "m: $.network").error();
  EXPECT_EQ(op.code, ErrorCode::kUnsupported);
  EXPECT_EQ(op.location, "m: $.network.layers[2].op");
  EXPECT_THAT(op.message, HasSubstr("pixel-shuffle"));
}

TEST(NetworkJson, RefusesUnknownKeysAndWrongTypes) {
  const auto error_of = [](const Json& json) { return network_from_json(json, "m: $.network").error(); };
  Json json = to_json(two_scales());
  json["layers"][1]["kernels"] = 3;
  EXPECT_EQ(error_of(json).location, "m: $.network.layers[1].kernels");
  json = to_json(two_scales());
  for (const Json& bad : {Json(-3), Json(2.5), Json("3"), Json(true), Json(nullptr)}) {
    json["layers"][1]["kernel"] = bad;
    EXPECT_EQ(error_of(json).code, ErrorCode::kInvalidValue) << bad;
    EXPECT_EQ(error_of(json).location, "m: $.network.layers[1].kernel") << bad;
  }
  EXPECT_EQ(error_of(Json::parse(R"({"type": "conv-graph", "input_channels": 3})")).code, ErrorCode::kFormat);
  EXPECT_EQ(error_of(Json::array()).code, ErrorCode::kFormat);
}

TEST(NetworkJson, RefusesNetworksWhoseShapesDoNotFit) {
  Json json = to_json(two_scales());
  json["layers"][1]["kernel"] = 4;
  const Error error = network_from_json(json, "m: $.network").error();
  EXPECT_EQ(error.code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error.location, "m: $.network: layer \"a\"");
}

}  // namespace
}  // namespace e2lf::model
