// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <torch/torch.h>

#include "e2lf/engine/engine.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/learn/network/network_module.h"
#include "testing/test_networks.h"

namespace e2lf::learn {
namespace {

using engine::conv, engine::reshape;
using Function = std::function<torch::Tensor(const torch::Tensor&)>;

model::Layer sweep_layer() {
  auto layer = reshape("sweep", geometry::GeometryOp::kPlaneSweep, {"input"});
  layer.kernel = 3;
  layer.attributes = {{"offsets", {-1.5, 0.75, 0.5, -2}}, {"disparities", {-1.2, 0, 0.7}}};
  return layer;
}

model::Layer render_layer() {
  auto layer = reshape("views", geometry::GeometryOp::kRenderLayers, {"input"});
  layer.attributes = {{"disparities", {-1.2, 0.1, 0.7}}, {"rows", {-1.5, 0.5}}, {"columns", {-3.5, 0, 2}}};
  return layer;
}

model::Layer warp_layer() {
  auto layer = reshape("moved", geometry::GeometryOp::kWarp, {"pictures", "map"});
  layer.attributes = {{"offsets", {-1.5, 0.75, 0.5, -2}}, {"disparities", {-1.2, 0.7}}};
  return layer;
}

torch::Tensor apply(TorchOperation operation, const model::Layer& layer, const torch::Tensor& input) {
  return operation({layer, {input}, {}});
}

/// Compares the derivative of a weighted sum of the outputs along a random direction with a difference quotient.
void expect_gradient(const Function& function, const torch::Tensor& at) {
  torch::manual_seed(4);
  const auto x = at.clone().requires_grad_(true);
  const auto weights = torch::randn_like(function(at)), direction = torch::randn_like(at);
  (function(x) * weights).sum().backward();
  const double step = 1e-6, expected = ((function(at + step * direction) - function(at - step * direction)) * weights)
                                           .sum()
                                           .item<double>() /
                                       (2 * step);
  EXPECT_NEAR((x.grad() * direction).sum().item<double>(), expected, 1e-6 * (1 + std::abs(expected)));
}

TEST(GeometryOperationsOfTorch, HaveTheGradientsOfTheirValues) {
  torch::manual_seed(3);
  expect_gradient([](const torch::Tensor& x) { return apply(apply_plane_sweep, sweep_layer(), x); },
                  torch::randn({2, 4, 7, 9}, torch::kDouble));
  expect_gradient([](const torch::Tensor& x) { return apply(apply_render_layers, render_layer(), x); },
                  torch::randn({2, 6, 7, 9}, torch::kDouble));
  const auto pictures = torch::randn({2, 4, 7, 9}, torch::kDouble), map = torch::randn({2, 1, 7, 9}, torch::kDouble);
  expect_gradient([&](const torch::Tensor& x) { return apply_warp({warp_layer(), {x, map}, {}}); }, pictures);
  expect_gradient([&](const torch::Tensor& x) { return apply_warp({warp_layer(), {pictures, x}, {}}); }, map);
}

TEST(GeometryOperationsOfTorch, SweepEachSampleAtItsOwnOffsets) {
  torch::manual_seed(3);
  const auto pictures = torch::randn({3, 2, 4, 8, 11}, torch::kDouble);
  const auto offsets =
      torch::tensor({{{-1.5, 0.75}, {0.5, -2.0}}, {{0.0, 0.0}, {1.0, 2.5}}, {{-2.2, 0.3}, {0.1, 0.1}}}, torch::kDouble);
  const std::vector<double> disparities = {-1.2, 0.0, 0.7, 2.0};
  const auto together = sweep_planes(pictures, offsets, disparities, 5);
  for (int64_t s = 0; s < 3; ++s) {
    const auto alone = sweep_planes(pictures.narrow(0, s, 1), offsets.narrow(0, s, 1), disparities, 5);
    EXPECT_TRUE(torch::allclose(together.narrow(0, s, 1), alone, 0, 1e-12)) << s;
  }
  expect_gradient([&](const torch::Tensor& x) { return sweep_planes(x, offsets, disparities, 5); }, pictures);
}

/// Two pictures of one texture that lies at disparity 1 agree most there.
TEST(GeometryOperationsOfTorch, EvidenceIsLargestAtTheDisparityOfTheScene) {
  torch::manual_seed(3);
  const auto texture = torch::randn({1, 1, 1, 24, 24});
  const auto pictures = torch::cat({texture.roll(1, -1), texture.roll(-1, -1)}, 1);  // seen from columns 1 and -1
  const auto offsets = torch::tensor({{{0.0, 1.0}, {0.0, -1.0}}}, torch::kDouble);
  const auto evidence = sweep_planes(pictures, offsets, {-1, 0, 1, 2}, 5);
  const auto inside = evidence.slice(2, 6, 18).slice(3, 6, 18);
  EXPECT_TRUE((inside.argmax(1) == 2).all().item<bool>());
}

/// The operations between convolutions, at two resolutions, in the engine and here.
TEST(GeometryOperationsOfTorch, EqualThoseOfTheEngine) {
  geometry::add_operations();
  auto sweep = sweep_layer(), views = render_layer(), moved = warp_layer();
  moved.inputs = {"features", "map"};
  sweep.inputs = {"moved"};
  views.inputs = {"planes"};
  const model::Network network = {
      3,
      {conv("features", "input", 4, 2, false, "", 2), conv("map", "input", 1, 2, false, "", 2), moved, sweep,
       conv("weighed", "sweep", 24, 3), reshape("planes", model::Op::kPixelShuffle, {"weighed"}, 2), views}};
  torch::manual_seed(9);
  torch::NoGradGuard no_grad;
  const NetworkModule module(network, torch::kCPU);
  const auto input = torch::randn({1, 3, 26, 34});
  const auto expected = module.forward(input, torch::kFloat).contiguous();
  const auto engine =
      engine::Engine::create(network, to_weights(module.parameters()), {.precision = engine::Precision::kFloat32});
  ASSERT_TRUE(engine) << engine.error().text();
  std::vector<float> output(static_cast<size_t>(expected.numel()));
  ASSERT_TRUE(engine->run({input.data_ptr<float>(), static_cast<size_t>(input.numel())}, 26, 34, output));
  const auto difference = (torch::from_blob(output.data(), expected.sizes()) - expected).abs().max().item<float>();
  EXPECT_LT(difference, 2e-5F * expected.abs().max().item<float>());
}

}  // namespace
}  // namespace e2lf::learn
