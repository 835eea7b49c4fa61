// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/network_module.h"

#include <gtest/gtest.h>

#include "e2lf/learn/optimisers/optimisers.h"

namespace e2lf::learn {
namespace {

using model::Layer;
using model::Network;
using model::Op;

Layer layer(const std::string& name, const char* op, std::vector<std::string> inputs) {
  Layer result;
  result.name = name;
  result.op = op;
  result.inputs = std::move(inputs);
  return result;
}

TEST(NetworkModule, ShufflesChannelsAsTorchDoes) {
  Network network;
  network.input_channels = 2;
  network.layers = {layer("down", Op::kPixelUnshuffle, {"input"}), layer("up", Op::kPixelShuffle, {"down"})};
  network.layers[0].stride = network.layers[1].stride = 2;
  const auto input = torch::randn({2, 2, 6, 10});
  EXPECT_TRUE(torch::equal(NetworkModule(network, torch::kCPU).forward(input, torch::kFloat), input));
  network.layers.pop_back();
  EXPECT_TRUE(
      torch::equal(NetworkModule(network, torch::kCPU).forward(input, torch::kFloat), at::pixel_unshuffle(input, 2)));
}

TEST(NetworkModule, TransposedConvolutionMatchesTorch) {
  torch::manual_seed(1);
  Network network;
  network.input_channels = 3;
  network.layers = {layer("down", Op::kPixelUnshuffle, {"input"}), layer("up", Op::kConvTransposed, {"down"})};
  network.layers[1].out_channels = 5;
  network.layers[0].stride = network.layers[1].kernel = network.layers[1].stride = 2;
  const NetworkModule module(network, torch::kCPU);
  torch::NoGradGuard no_grad;
  auto bias = module.parameters().at("up.bias");
  bias.normal_();
  const auto input = torch::randn({2, 3, 4, 6});
  const auto down = at::pixel_unshuffle(input, 2);
  const auto expected = at::conv_transpose2d(down, module.parameters().at("up.weight"), bias, 2);
  EXPECT_LT((module.forward(input, torch::kFloat) - expected).abs().max().item<float>(), 1e-5F);
}

TEST(NetworkModule, AddsTheResidualBeforeTheActivationAndJoinsTensors) {
  torch::manual_seed(2);
  Network network;
  network.input_channels = 2;
  network.layers = {layer("a", Op::kConv, {"input"}), layer("sum", Op::kAdd, {"a", "input"}),
                    layer("both", Op::kConcat, {"sum", "a"}), layer("down", Op::kPixelUnshuffle, {"both"}),
                    layer("large", Op::kUpsample, {"down"})};
  network.layers[0].out_channels = 2;
  network.layers[0].kernel = 3;
  network.layers[0].residual = "input";
  network.layers[0].relu = true;
  network.layers[3].stride = network.layers[4].stride = 2;
  const NetworkModule module(network, torch::kCPU);
  const auto input = torch::randn({1, 2, 4, 4});
  // A convolution with a residual starts at zero: a = relu(input).
  const auto a = torch::relu(input);
  const auto down = at::pixel_unshuffle(torch::cat({a + input, a}, 1), 2);
  const auto expected = at::upsample_nearest2d(down, {4, 4});
  EXPECT_TRUE(torch::equal(module.forward(input, torch::kFloat).detach(), expected));
}

TEST(NetworkModule, RunsTheUnetForwardAndBackwardInBothPrecisions) {
  torch::manual_seed(3);
  const auto network = model::unet({.input_channels = 9, .widths = {8, 12}, .blocks = {1, 1}, .head_width = 8});
  const NetworkModule module(network, torch::kCPU);
  const auto input = torch::rand({2, 9, 16, 24});
  const auto in_float = module.forward(input, torch::kFloat), in_bfloat = module.forward(input, torch::kBFloat16);
  EXPECT_EQ(in_float.sizes(), (std::vector<int64_t>{2, 64, 16, 24}));
  EXPECT_EQ(in_bfloat.scalar_type(), torch::kFloat);
  EXPECT_LT((in_float - in_bfloat).abs().max().item<float>(), 0.05F * in_float.abs().max().item<float>());
  in_bfloat.square().mean().backward();
  for (const auto& [name, tensor] : module.parameters()) EXPECT_TRUE(tensor.grad().defined()) << name;
}

TEST(NetworkModule, GradientMatchesDifferencesAlongARandomDirection) {
  torch::manual_seed(4);
  const NetworkModule module(
      model::unet({.input_channels = 4, .output_channels = 8, .widths = {6, 8}, .blocks = {1, 1}, .head_width = 4}),
      torch::kCPU);
  const auto input = torch::rand({1, 4, 8, 8}, torch::kDouble);
  NamedTensors weights, direction;
  for (const auto& [name, tensor] : module.parameters()) {
    weights[name] = (tensor.detach().to(torch::kDouble) + 0.1 * torch::randn(tensor.sizes(), torch::kDouble))
                        .set_requires_grad(true);
    direction[name] = torch::randn(tensor.sizes(), torch::kDouble);
  }
  const auto loss = [&](const NamedTensors& at) { return module.forward(input, torch::kDouble, &at).square().mean(); };
  loss(weights).backward();
  double expected = 0;
  NamedTensors above, below;
  constexpr double kStep = 1e-6;
  torch::NoGradGuard no_grad;
  for (const auto& [name, tensor] : weights) {
    expected += (tensor.grad() * direction.at(name)).sum().item<double>();
    above[name] = tensor + kStep * direction.at(name);
    below[name] = tensor - kStep * direction.at(name);
  }
  const double measured = (loss(above).item<double>() - loss(below).item<double>()) / (2 * kStep);
  EXPECT_NEAR(measured / expected, 1.0, 1e-4);
}

TEST(LoadWeights, RestoresWhatToWeightsGaveAndNamesWhatIsMissing) {
  const auto network = model::unet({.input_channels = 9, .widths = {8}, .blocks = {1}, .head_width = 4});
  torch::manual_seed(5);
  const NetworkModule first(network, torch::kCPU), second(network, torch::kCPU);
  auto weights = to_weights(first.parameters());
  ASSERT_TRUE(load_weights(second.parameters(), weights, "file"));
  for (const auto& [name, tensor] : first.parameters()) EXPECT_TRUE(torch::equal(tensor, second.parameters().at(name)));
  weights["stem.bias"].pop_back();
  EXPECT_EQ(load_weights(second.parameters(), weights, "file").error().code, ErrorCode::kShape);
  weights.erase("stem.bias");
  const auto missing = load_weights(second.parameters(), weights, "file");
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(missing.error().message.find("stem.bias"), std::string::npos);
}

TEST(Adam, MovesByTheLearningRateFirstAndFollowsItsMomentsThen) {
  auto x = torch::tensor({1.0F, -2.0F}).set_requires_grad(true);
  const NamedTensors parameters = {{"x", x}};
  Adam adam(parameters);
  (x * torch::tensor({3.0F, -0.01F})).sum().backward();
  adam.update(parameters, 0.1, 1);
  EXPECT_NEAR(x[0].item<float>(), 0.9F, 1e-5F);
  EXPECT_NEAR(x[1].item<float>(), -1.9F, 1e-4F);
  // The same gradient again keeps both bias-corrected moments, so the second step is as long as the first.
  adam.update(parameters, 0.1, 2);
  EXPECT_NEAR(x[0].item<float>(), 0.8F, 1e-5F);
}

TEST(ClipGradients, ScalesTheJointNormAndReportsTheOneBefore) {
  auto x = torch::zeros({1}).set_requires_grad(true), y = torch::zeros({1}).set_requires_grad(true);
  const NamedTensors parameters = {{"x", x}, {"y", y}};
  (3.0 * x + 4.0 * y).sum().backward();
  EXPECT_NEAR(clip_gradients(parameters, 10.0), 5.0, 1e-6);
  EXPECT_NEAR(x.grad().item<float>(), 3.0F, 1e-6F);
  EXPECT_NEAR(clip_gradients(parameters, 1.0), 5.0, 1e-6);
  EXPECT_NEAR(y.grad().item<float>(), 0.8F, 1e-6F);
  zero_gradients(parameters);
  EXPECT_FALSE(x.grad().defined());
}

TEST(UpdateAverage, IsTheClosedFormOfAMovingAverage) {
  const NamedTensors average = {{"x", torch::zeros({1})}}, parameters = {{"x", torch::ones({1})}};
  for (int i = 0; i < 10; ++i) update_average(average, parameters, 0.9);
  EXPECT_NEAR(average.at("x").item<float>(), 1.0 - std::pow(0.9, 10), 1e-6);
}

}  // namespace
}  // namespace e2lf::learn
