// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/any_patterns.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <torch/torch.h>

#include "e2lf/engine/engine.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/task.h"

namespace e2lf::learn {
namespace {

const std::vector<size_t> kWidths = {4, 6};

/// Black and three lit boxes, of which the last begins in row `top`.
capture::Codes boxes(size_t top) {
  capture::Codes codes(4, 8, 8);
  const auto open = [&](size_t n, size_t y, size_t x) {
    for (size_t i = 0; i < 9; ++i) codes.pattern(n)[(y + i / 3) * 8 + x + i % 3] = 1;
  };
  open(1, 1, 1);
  open(2, 2, 4);
  open(3, top, 3);
  return codes;
}

/// A network whose residual blocks are not the identity.
AnyPatternsModule random_module() {
  torch::manual_seed(5);
  torch::NoGradGuard no_grad;
  AnyPatternsModule module(kWidths, torch::kCPU);
  for (const auto& [name, tensor] : module.module().parameters()) {
    auto parameter = tensor;
    parameter.add_(0.05 * torch::randn_like(parameter));
  }
  return module;
}

DepthInputs random_inputs(int64_t batch, size_t num_patterns, int64_t size) {
  const auto transitions = static_cast<int64_t>(num_patterns) - 1;
  DepthInputs inputs{torch::randn({batch, 3, transitions, size, size}),
                     torch::rand({batch, static_cast<int64_t>(capture::conditioning_size(num_patterns))}) - 0.5,
                     torch::empty({batch, size, size})};
  inputs.cycles.copy_(inputs.conditioning.select(1, capture::kCyclesCondition).reshape({batch, 1, 1}));
  return inputs;
}

/// What the engine computes with the weights that are adapted to the patterns.
torch::Tensor of_engine(const AnyPatternsModule& module, const capture::Codes& codes, const DepthInputs& inputs) {
  model::Model model;
  model.name = "small";
  model.num_patterns = 4;
  model.codes = boxes(4);
  model.camera.emplace();
  model.input = {{model::InputKind::kCumulative, 0.125F},
                 {model::InputKind::kLevel, 0.125F},
                 {model::InputKind::kIntensity, 4.0F},
                 {model::InputKind::kCamera, 1.0F}};
  model.network = depth_network(kWidths, model::num_input_channels(model.input, 4));
  for (const auto& tensor : model::weight_shapes(model.network)) {
    model.weights[tensor.name] = std::vector<float>(tensor.size());
  }
  AnyPatternsModule::store(module.module().parameters(), model);
  const auto adapted = geometry::for_patterns(model, codes);
  EXPECT_TRUE(adapted) << adapted.error().text();
  const auto engine =
      engine::Engine::create(adapted->network, adapted->weights, {.precision = engine::Precision::kFloat32});
  EXPECT_TRUE(engine) << engine.error().text();
  const int64_t size = inputs.groups.size(4);
  const auto planes = inputs.conditioning[0].reshape({-1, 1, 1}).expand({-1, size, size});
  const auto input = torch::cat({inputs.groups[0].flatten(0, 1), planes}).contiguous();
  const auto output = torch::empty({2, size, size});
  const auto length = static_cast<size_t>(size);
  EXPECT_TRUE(engine->run({input.data_ptr<float>(), static_cast<size_t>(input.numel())}, length, length,
                          {output.data_ptr<float>(), static_cast<size_t>(output.numel())}));
  return output;
}

void expect_engine_parity(const capture::Codes& codes) {
  const AnyPatternsModule module = random_module();
  torch::NoGradGuard no_grad;
  const DepthInputs inputs = random_inputs(1, codes.num_patterns, 32);
  const auto apertures = describe_apertures({codes}, torch::kCPU).value();
  const auto actual = module.forward(inputs, apertures, torch::kFloat)[0];
  const auto expected = of_engine(module, codes, inputs);
  const float scale = expected.abs().max().item<float>();
  EXPECT_GT(scale, 0.01F);
  EXPECT_LT((actual - expected).abs().max().item<float>(), 1e-4F * scale);
}

TEST(AnyPatternsModule, EqualsTheNetworkThatIsAdaptedToThePatterns) {
  expect_engine_parity(boxes(4));
  expect_engine_parity(capture::whole_cycle(boxes(5)));
}

TEST(AnyPatternsModule, SamplesOfABatchHaveTheirOwnPatterns) {
  const AnyPatternsModule module = random_module();
  torch::NoGradGuard no_grad;
  const std::vector<capture::Codes> codes = {boxes(3), boxes(5)};
  const DepthInputs inputs = random_inputs(2, 4, 32);
  const auto both = module.forward(inputs, describe_apertures(codes, torch::kCPU).value(), torch::kFloat);
  for (int64_t i = 0; i < 2; ++i) {
    const DepthInputs own = {inputs.groups.narrow(0, i, 1), inputs.conditioning.narrow(0, i, 1),
                             inputs.cycles.narrow(0, i, 1)};
    const auto apertures = describe_apertures({codes[static_cast<size_t>(i)]}, torch::kCPU).value();
    EXPECT_TRUE(torch::allclose(both[i], module.forward(own, apertures, torch::kFloat)[0], 1e-4, 1e-5)) << i;
  }
}

TEST(AnyPatternsModule, EveryWeightLearns) {
  const AnyPatternsModule module = random_module();
  const DepthInputs inputs = random_inputs(2, 4, 32);
  const auto apertures = describe_apertures({boxes(3), boxes(5)}, torch::kCPU).value();
  module.forward(inputs, apertures, torch::kFloat).square().mean().backward();
  for (const auto& [name, tensor] : module.module().parameters()) {
    ASSERT_TRUE(tensor.grad().defined()) << name;
    EXPECT_GT(tensor.grad().abs().max().item<float>(), 0.0F) << name;
  }
}

/// The numbers (29 i + 13 n) mod 31, from -1 to 1, over the square root of the number of weights of an output.
torch::Tensor numbered(const std::string& name, const torch::Tensor& like) {
  const int64_t number = like.numel(), outputs = name == "up0_double.weight" ? number / like.size(0) : like.size(0);
  const double scale = name.ends_with(".bias") ? 4 : std::sqrt(static_cast<double>(number / outputs));
  const auto values = (29 * torch::arange(number) + 13 * number).remainder(31).to(torch::kDouble) / 15.5 - 1;
  return (values / scale).to(torch::kFloat).reshape(like.sizes());
}

/// Steps of training, against those of the scripts in Python that trained the bundled network (docs/experiments/
/// geometry.md), from the same weights, inputs and disparities.
TEST(AnyPatternsModule, LearnsInTheStepsOfTheScripts) {
  constexpr int64_t kLength = 32;
  const AnyPatternsModule module(kWidths, torch::kCPU);
  const NamedTensors& parameters = module.module().parameters();
  {
    torch::NoGradGuard no_grad;
    for (const auto& [name, tensor] : parameters) torch::Tensor(tensor).copy_(numbered(name, tensor));
  }
  const auto sample = torch::arange(2).reshape({2, 1, 1, 1}), channel = torch::arange(9).reshape({1, 9, 1, 1}),
             y = torch::arange(kLength).reshape({kLength, 1}), x = torch::arange(kLength);
  DepthInputs inputs;
  inputs.groups =
      ((31 * channel + 17 * y + 7 * x + 5 * sample).remainder(23).to(torch::kFloat) / 11.5 - 1).unflatten(1, {3, 3});
  const auto conditions = ((7 * torch::arange(15)).remainder(5) - 2).to(torch::kFloat) * 0.2;
  inputs.conditioning = torch::cat({conditions, torch::tensor({0.25F, 0.1F, 0.2F})}).expand({2, -1});
  inputs.cycles = torch::full({2, kLength, kLength}, 0.25);
  const auto disparity = (3 * y + 5 * x + 2 * sample.squeeze(1)).remainder(13).to(torch::kFloat) / 6.5 - 1;
  const auto apertures = describe_apertures({boxes(4), boxes(5)}, torch::kCPU).value();

  NamedTensors by_muon = muon_weights(module.module()), by_adam = parameters;
  for (const char* name : {"pictures.weight", "features.weight", "head.weight"}) by_muon.erase(name);
  for (const auto& each : by_muon) by_adam.erase(each.first);
  Muon muon(by_muon);
  Adam adam(by_adam, 0.99);
  const std::map<int, double> golden = {{0, 1.0415053},  {1, 0.9884907},  {2, 0.9403944}, {10, 0.8572835},
                                        {30, 0.7788628}, {60, 0.6662058}, {99, 0.4861448}};
  for (int step = 0; step < 100; ++step) {
    zero_gradients(parameters);
    const auto loss = depth_loss(module.forward(inputs, apertures, torch::kFloat), disparity).loss;
    loss.backward();
    if (const auto found = golden.find(step); found != golden.end()) {
      EXPECT_NEAR(loss.item<double>(), found->second, step < 90 ? 1e-3 : 5e-3) << step;  // rounding grows
    }
    clip_gradients(parameters, 5);
    muon.update(by_muon, 1e-3);
    adam.update(by_adam, 1e-3, static_cast<uint64_t>(step) + 1);
  }
}

TEST(AnyPatternsModule, PatternsWithoutParallaxAreRefused) {
  capture::Codes same(3, 8, 8);
  same.pattern(1)[9] = same.pattern(2)[9] = 1;
  EXPECT_EQ(describe_apertures({same}, torch::kCPU).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::learn
