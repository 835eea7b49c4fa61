// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/model/network.h"

namespace e2lf::learn {
namespace {

constexpr int64_t kOut = 5, kIn = 3;

struct Convolution {
  NamedTensors parameters = {{"a.weight", torch::randn({kOut, kIn, 3, 3}).set_requires_grad(true)},
                             {"a.bias", torch::randn({kOut}).set_requires_grad(true)}};
  torch::Tensor operator()(const torch::Tensor& x) const {
    return at::conv2d(x, parameters.at("a.weight"), parameters.at("a.bias"));
  }
};

TEST(CentreGradients, GiveThoseOfTheConvolutionOfTheInputWithoutItsMean) {
  torch::manual_seed(5);
  const Convolution plain;
  const auto x = torch::randn({2, kIn, 7, 6}) + 3.0;
  const auto mean = x.mean({0, 2, 3});
  plain(x).square().sum().backward();
  centre_gradients(plain.parameters, {{"a", mean}});

  Convolution centred;
  {
    torch::NoGradGuard no_grad;
    const auto weight = plain.parameters.at("a.weight"), bias = plain.parameters.at("a.bias");
    auto target = centred.parameters.at("a.weight");
    target.copy_(weight);
    target = centred.parameters.at("a.bias");
    target.copy_(bias + torch::mv(weight.sum({2, 3}), mean));
  }
  centred(x - mean.reshape({1, -1, 1, 1})).square().sum().backward();
  for (const char* name : {"a.weight", "a.bias"}) {
    EXPECT_TRUE(torch::allclose(plain.parameters.at(name).grad(), centred.parameters.at(name).grad(), 1e-3, 1e-2))
        << name;
  }
}

TEST(KeepMeanOutputs, LeavesWhatTheConvolutionMakesOfTheMeanButForTheStepOfTheBias) {
  torch::manual_seed(6);
  torch::NoGradGuard no_grad;
  const Convolution convolution;
  const auto mean = torch::randn({kIn}) + 2.0;
  const auto constant = mean.reshape({1, -1, 1, 1}).expand({1, kIn, 3, 3});
  const auto expected = convolution(constant).flatten() + 0.25;
  const NamedTensors before = {{"a.weight", convolution.parameters.at("a.weight").detach().clone()}};
  auto weight = convolution.parameters.at("a.weight"), bias = convolution.parameters.at("a.bias");
  weight.add_(torch::randn_like(weight));
  bias.add_(0.25);
  keep_mean_outputs(convolution.parameters, before, {{"a", mean}});
  EXPECT_TRUE(torch::allclose(convolution(constant).flatten(), expected, 1e-4, 1e-4));
}

TEST(InputMeans, AreOfEveryConvolutionOfThePass) {
  torch::manual_seed(7);
  const NetworkModule network(model::unet({.widths = {8, 8}, .blocks = {1, 1}, .head_width = 4}), torch::kCPU);
  const auto input = torch::randn({2, static_cast<int64_t>(network.network().input_channels), 16, 8});
  NamedTensors means;
  const auto output = network.forward(input, torch::kFloat, nullptr, &means);
  EXPECT_TRUE(torch::allclose(means.at("skip"), input.mean({0, 2, 3}), 1e-5, 1e-6));
  EXPECT_EQ(means.at("down0_0b").numel(), 8);
  EXPECT_FALSE(means.at("down0_0b").requires_grad());
  EXPECT_FALSE(means.contains("up0_double"));  // transposed
}

}  // namespace
}  // namespace e2lf::learn
