// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/engine/engine.h"
#include "e2lf/files/safetensors.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/model/unet.h"
#include "e2lf/model/video/import_event_video.h"
#include "testing/event_video_checkpoints.h"
#include "testing/test_files.h"
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

/// The same over frames of a network that remembers.
void expect_parity_over_frames(const model::Network& network, const model::Weights& weights, int64_t height,
                               int64_t width) {
  torch::manual_seed(9);
  torch::NoGradGuard no_grad;
  const NetworkModule module(network, torch::kCPU);
  ASSERT_TRUE(load_weights(module.parameters(), weights, "weights"));
  const auto engine = engine::Engine::create(network, weights, {.precision = engine::Precision::kFloat32});
  ASSERT_TRUE(engine) << engine.error().text();
  NamedTensors torch_state;
  engine::FrameState state;
  for (int frame = 0; frame < 3; ++frame) {
    const auto input = torch::randn({1, static_cast<int64_t>(network.input_channels), height, width});
    const auto expected = module.forward_frame(input, torch::kFloat, torch_state).contiguous();
    std::vector<float> output(static_cast<size_t>(expected.numel()));
    const auto ran = engine->run_frame({input.data_ptr<float>(), static_cast<size_t>(input.numel())},
                                       static_cast<size_t>(height), static_cast<size_t>(width), state, output);
    ASSERT_TRUE(ran) << ran.error().text();
    const auto actual = torch::from_blob(output.data(), expected.sizes());
    const float scale = expected.abs().max().item<float>();
    EXPECT_GT(scale, 0.01F);
    EXPECT_LT((actual - expected).abs().max().item<float>(), 2e-4F * scale) << "frame " << frame;
  }
}

/// Networks as they are imported, with random weights.
model::VideoModel imported(const Safetensors& checkpoint) {
  const TestFolder folder;
  EXPECT_TRUE(write_safetensors(folder / "c.safetensors", checkpoint));
  return model::import_event_video(folder / "c.safetensors").value();
}

TEST(EngineParity, TheRecurrentUnetGivesTheSameFrames) {
  for (const bool is_normalised : {false, true}) {
    const auto model = imported(model::unet_checkpoint({.is_normalised = is_normalised, .channels = 12}));
    expect_parity_over_frames(model.network, model.weights, 40, 56);
  }
}

TEST(EngineParity, HyperE2vidGivesTheSameFrames) {
  const auto model = imported(model::unet_checkpoint({.channels = 12, .is_dynamic = true}));
  expect_parity_over_frames(model.network, model.weights, 40, 56);
}

TEST(EngineParity, EtNetGivesTheSameFrames) {
  const auto model = imported(model::transformer_checkpoint({.channels = 8, .wide = 100}));
  expect_parity_over_frames(model.network, model.weights, 40, 56);
}

TEST(EngineParity, PixelsThatSeeTheWholeImageGiveTheSameFrames) {
  for (const auto& test : engine::whole_image_networks()) {
    const auto multiple = static_cast<int64_t>(test.multiple);
    expect_parity_over_frames(test.network, engine::random_weights(test.network, 5), 11 * multiple, 7 * multiple);
  }
}

TEST(EngineParity, EveryKindOfLayerGivesTheSameLightField) {
  for (const auto& test : engine::test_networks()) {
    const auto multiple = static_cast<int64_t>(test.multiple);
    expect_parity(test.network, 11 * multiple, 7 * multiple);
  }
}

TEST(EngineParity, FireNetGivesTheSameFrames) {
  const auto model = imported(model::firenet_checkpoint(true));
  expect_parity_over_frames(model.network, model.weights, 21, 35);
}

/// Every kind of layer of these networks alone.
TEST(EngineParity, EveryRecurrentLayerGivesTheSameFrames) {
  for (const auto& test : engine::recurrent_networks()) {
    const auto multiple = static_cast<int64_t>(test.multiple);
    expect_parity_over_frames(test.network, engine::random_weights(test.network, 5), 5 * multiple, 7 * multiple);
  }
}

TEST(EngineParity, ThePapersNetworkGivesTheSameLightField) {
  expect_parity(model::recnet(3, 64, 16), 21, 35);
}

}  // namespace
}  // namespace e2lf::learn
