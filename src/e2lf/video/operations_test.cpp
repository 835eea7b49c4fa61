// SPDX-License-Identifier: MIT
// The shapes, figures, files and exports of operations of networks for frames; other tests compute them.
#include "e2lf/video/operations.h"

#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/model/onnx/onnx_export.h"

namespace e2lf::video {
namespace {

using namespace model;

Layer layer(const std::string& name, const char* op, std::vector<std::string> inputs) {
  Layer result;
  result.name = name;
  result.op = op;
  result.inputs = std::move(inputs);
  return result;
}

Layer plain_conv(const std::string& name, const std::string& input, size_t out_channels, size_t kernel,
                 size_t stride = 1) {
  Layer result = layer(name, VideoOp::kConv, {input});
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

Error shapes_error(const Network& network) {
  const auto shapes = infer_shapes(network);
  EXPECT_FALSE(shapes.ok());
  return shapes.ok() ? Error{} : shapes.error();
}

/// Filters of 3x3 made of the input and of the last output.
Network with_feedback() {
  add_operations();
  Network network;
  network.input_channels = 2;
  Layer previous = layer("previous", VideoOp::kPrevious, {});
  previous.out_channels = 8;
  Layer filtered = layer("filtered", VideoOp::kDynamicFilter, {"input", "filters"});
  filtered.kernel = 3;
  network.layers = {previous, layer("both", VideoOp::kConcat, {"input", "previous"}),
                    plain_conv("filters", "both", 36, 1), filtered, layer("out", VideoOp::kTanh, {"filtered"})};
  return network;
}

/// Programs without this component are told of it.
TEST(VideoOperations, AreNamedWithTheirComponentWhereTheyAreMissing) {
  for (const engine::Operation& operation :
       {attention(), bilinear_upsampling(), conv_gru(), conv_lstm(), dynamic_filter(), layer_norm(), position_code(),
        previous_output(), hyperbolic_tangent()}) {
    const std::string text = model::unknown_operation(operation.model.name, "").text();
    EXPECT_NE(text.find("e2lf::video::add_operations()"), std::string::npos) << text;
  }
}

TEST(VideoOperations, PixelsWithFiltersOfTheirOwnHaveAResultOfEach) {
  const Network network = with_feedback();
  const auto shapes = infer_shapes(network);
  ASSERT_TRUE(shapes.ok()) << shapes.error().text();
  EXPECT_EQ(shapes->at(3).channels, 4U * 2U);
  EXPECT_TRUE(is_recurrent(network));
  EXPECT_EQ(num_parameters(network), 36U * 10U + 36U);
  EXPECT_DOUBLE_EQ(macs_per_pixel(network), 36 * 10 + 8 * 9);
  EXPECT_EQ(receptive_radius(network), 1U);
}

TEST(VideoOperations, RefusesFiltersAndFeedbackThatDoNotFit) {
  const auto error_after = [](const std::function<void(Network&)>& change) {
    Network network = with_feedback();
    change(network);
    return shapes_error(network);
  };
  EXPECT_EQ(error_after([](Network& n) { n.layers[2].out_channels = 35; }).code, ErrorCode::kShape);
  EXPECT_EQ(error_after([](Network& n) { n.layers[0].out_channels = 7; }).location, "layer \"previous\"");
  EXPECT_EQ(error_after([](Network& n) { n.layers[0].inputs = {"input"}; }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers[3].inputs.pop_back(); }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers[3].kernel = 2; }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers[3].stride = 2; }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers[4].relu = true; }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers.resize(1); }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers.push_back(plain_conv("half", "out", 8, 2, 2)); }).code,
            ErrorCode::kShape);
}

/// Pixels of half the resolution that look at one another.
Network with_attention() {
  add_operations();
  Network network;
  network.input_channels = 2;
  Layer look = layer("look", VideoOp::kAttention, {"norm", "a", "a"});
  look.attributes["heads"] = {3};
  network.layers = {plain_conv("a", "input", 12, 2, 2),
                    layer("place", VideoOp::kPositionCode, {"a"}),
                    layer("norm", VideoOp::kLayerNorm, {"place"}),
                    look,
                    layer("mean", VideoOp::kMean, {"look", "a", "place"}),
                    strided("out", VideoOp::kUpsample, "mean", 2)};
  return network;
}

TEST(VideoOperations, PixelsThatLookAtAllKeepTheirShape) {
  const Network network = with_attention();
  const auto shapes = infer_shapes(network);
  ASSERT_TRUE(shapes.ok()) << shapes.error().text();
  EXPECT_EQ(shapes->at(3).channels, 12U);
  EXPECT_EQ(shapes->at(3).scale, 2U);
  EXPECT_FALSE(is_recurrent(network));
  EXPECT_EQ(num_parameters(network), 12U * 2U * 4U + 12U + 2U * 12U);
  EXPECT_EQ(weight_shapes(network).at(2).name, "norm.weight");
  EXPECT_EQ(weight_shapes(network).at(2).shape, std::vector<size_t>{12});
  EXPECT_EQ(macs_per_pixel(network), 12.0 * 2.0);
  EXPECT_EQ(receptive_radius(network), kWholeImage);
}

TEST(VideoOperations, RefusesAttentionThatDoesNotFit) {
  const auto error_after = [](const std::function<void(Network&)>& change) {
    Network network = with_attention();
    change(network);
    return shapes_error(network);
  };
  for (const double heads : {0.0, 5.0, 24.0, 1.5, -3.0}) {
    EXPECT_EQ(error_after([&](Network& n) { n.layers[3].attributes["heads"] = {heads}; }).code,
              ErrorCode::kInvalidValue);
  }
  EXPECT_EQ(error_after([](Network& n) { n.layers[3].inputs.pop_back(); }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers[3].inputs[1] = "input"; }).code, ErrorCode::kShape);
  EXPECT_EQ(error_after([](Network& n) { n.layers[3].relu = true; }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers[2].stride = 2; }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers[1].inputs = {"a", "a"}; }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after([](Network& n) { n.layers[4].inputs = {"a"}; }).code, ErrorCode::kInvalidValue);
}

TEST(VideoOperations, RoundTripAsJson) {
  for (const Network& network : {with_feedback(), with_attention()}) {
    const auto read = network_from_json(to_json(network), "x");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(*read, network);
  }
  EXPECT_EQ(to_json(with_attention())["layers"][3]["heads"], 3);
}

TEST(VideoOperations, ThoseWithoutAnEquivalentInOnnxAreRefusedByName) {
  EXPECT_THAT(onnx_refusal(with_feedback()), testing::HasSubstr("previous"));
  EXPECT_THAT(onnx_refusal(with_attention()), testing::HasSubstr("place"));
}

}  // namespace
}  // namespace e2lf::video
