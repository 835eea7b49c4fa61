// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/model/network.h"

namespace e2lf::model {
namespace {

TEST(ConstantInputs, AreSummedIntoTheWeightsOfOneChannelOfOnes) {
  Network network;
  network.input_channels = 4;
  network.layers = {
      {.name = "a", .op = Op::kConv, .inputs = {"input"}, .out_channels = 1, .residual = ""},
      {.name = "down", .op = Op::kPixelUnshuffle, .inputs = {"input"}, .stride = 2, .residual = ""},
      {.name = "b", .op = Op::kConv, .inputs = {"down"}, .out_channels = 1, .residual = ""},
  };
  Weights weights;
  weights["a.weight"] = {1, 2, 3, 4};
  weights["b.weight"] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  const std::vector<float> values = {10, 100};
  const auto built = with_constant_inputs(network, weights, 1, values);
  ASSERT_TRUE(built.has_value());
  EXPECT_EQ(built->network.input_channels, 3U);
  EXPECT_EQ(built->weights.at("a.weight"), (std::vector<float>{1, 320, 4}));
  EXPECT_EQ(built->weights.at("b.weight"), (std::vector<float>{1, 2, 3, 4, 950, 1060, 1170, 1280, 13, 14, 15, 16}));
  network.layers.push_back({.name = "sum", .op = Op::kAdd, .inputs = {"a", "input"}, .residual = ""});
  EXPECT_FALSE(with_constant_inputs(network, weights, 1, values).has_value());
}

TEST(UnusedInputs, GetWeightsOfZeroWhereTheyAreInserted) {
  Network network;
  network.input_channels = 2;
  network.layers = {
      {.name = "down", .op = Op::kPixelUnshuffle, .inputs = {"input"}, .stride = 2, .residual = ""},
      {.name = "a", .op = Op::kConv, .inputs = {"down"}, .out_channels = 1, .residual = ""},
      {.name = "b", .op = Op::kConv, .inputs = {"input"}, .out_channels = 2, .residual = ""},
  };
  const Weights weights = {{"a.weight", {1, 2, 3, 4, 5, 6, 7, 8}}, {"b.weight", {1, 2, 3, 4}}};
  const auto with_more = with_unused_inputs(network, weights, 1, 1);
  ASSERT_TRUE(with_more.has_value());
  EXPECT_EQ(with_more->network.input_channels, 3U);
  EXPECT_EQ(with_more->weights.at("a.weight"), (std::vector<float>{1, 2, 3, 4, 0, 0, 0, 0, 5, 6, 7, 8}));
  EXPECT_EQ(with_more->weights.at("b.weight"), (std::vector<float>{1, 0, 2, 3, 0, 4}));
}

}  // namespace
}  // namespace e2lf::model
