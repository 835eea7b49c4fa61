// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/engine/engine.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/model/network.h"
#include "testing/test_networks.h"

namespace e2lf::learn {
namespace {

/// Both implementations on the same random weights and input.
void expect_parity(const model::Network& network, int64_t height, int64_t width) {
  torch::manual_seed(9);
  torch::NoGradGuard no_grad;
  const NetworkModule module(network, torch::kCPU);
  for (const auto& [name, tensor] : module.parameters()) {
    auto parameter = tensor;
    parameter.add_(0.03 * torch::randn_like(parameter));  // residual convolutions start at zero
  }
  const auto input = torch::rand({1, static_cast<int64_t>(network.input_channels), height, width});
  const auto expected = module.forward(input, torch::kFloat).contiguous();

  const auto engine =
      engine::Engine::create(network, to_weights(module.parameters()), {.precision = engine::Precision::kFloat32});
  ASSERT_TRUE(engine) << engine.error().text();
  std::vector<float> output(static_cast<size_t>(expected.numel()));
  const auto ran = engine->run({input.data_ptr<float>(), static_cast<size_t>(input.numel())},
                               static_cast<size_t>(height), static_cast<size_t>(width), output);
  ASSERT_TRUE(ran) << ran.error().text();
  const auto actual = torch::from_blob(output.data(), expected.sizes());
  const float scale = expected.abs().max().item<float>();
  EXPECT_GT(scale, 0.01F);
  EXPECT_LT((actual - expected).abs().max().item<float>(), 2e-4F * scale);
}

TEST(EngineParity, TheUnetGivesTheSameLightField) {
  expect_parity(model::unet({.input_channels = 9, .widths = {16, 24, 32}, .blocks = {1, 1, 2}, .head_width = 8}), 40,
                56);
}

TEST(EngineParity, BlocksAtFullResolutionGiveTheSameLightField) {
  expect_parity(model::unet({.input_channels = 9, .widths = {16}, .blocks = {1}, .head_width = 8, .head_blocks = 2}),
                26, 34);
}

TEST(EngineParity, ANetworkWithoutAHeadGivesTheSameLightField) {
  expect_parity(model::unet({.input_channels = 9, .widths = {16, 24}, .blocks = {1, 2}, .head_width = 0}), 28, 36);
}

TEST(EngineParity, EveryKindOfLayerGivesTheSameLightField) {
  for (const auto& test : engine::test_networks()) {
    const auto multiple = static_cast<int64_t>(test.multiple);
    expect_parity(test.network, 11 * multiple, 7 * multiple);
  }
}

TEST(EngineParity, ThePapersNetworkGivesTheSameLightField) {
  expect_parity(model::recnet(3, 64, 16), 21, 35);
}

}  // namespace
}  // namespace e2lf::learn
