// SPDX-License-Identifier: MIT
// An operation that a program adds, with two inputs, a list as attribute and a window of rows.
#include "e2lf/engine/operation.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "testing/engine_reference.h"
#include "testing/engine_runs.h"
#include "testing/test_networks.h"

namespace e2lf::engine {
namespace {

using model::Layer;
using model::LayerShape;

/// The shifts of a layer, px.
std::vector<ptrdiff_t> shifts_of(const Layer& layer) {
  std::vector<ptrdiff_t> shifts;
  for (const double shift : layer.attributes.at("shifts")) shifts.push_back(static_cast<ptrdiff_t>(shift));
  return shifts;
}

size_t reach_of(const Layer& layer) {
  size_t reach = 0;
  for (const ptrdiff_t shift : shifts_of(layer)) reach = std::max(reach, static_cast<size_t>(std::abs(shift)));
  return reach;
}

/// Makes the channel m of each shift s: the sum over c of a[c](y, x) b[c](y + s, x + s), a cost volume.
class CorrelationKernel final : public Kernel {
 public:
  CorrelationKernel(const Layer& layer, size_t channels)
      : shifts_(shifts_of(layer)), reach_(reach_of(layer)), channels_(channels) {}

  std::string describe() const override { return "correlation"; }
  Reach reach() const override { return {reach_, reach_, 1, 1}; }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const auto y = static_cast<ptrdiff_t>(strip.begin + block), width = static_cast<ptrdiff_t>(strip.width);
    const auto in = static_cast<ptrdiff_t>(padded_channels(channels_));
    const size_t out = padded_channels(shifts_.size());
    auto* to = strip.output.row<float>(y);
    for (ptrdiff_t x = 0; x < width; ++x, to += out) {
      const auto* a = strip.inputs[0].row<const float>(y) + x * in;
      for (size_t m = 0; m < shifts_.size(); ++m) {
        const auto* b = strip.inputs[1].row<const float>(y + shifts_[m]) + (x + shifts_[m]) * in;
        to[m] = 0.0F;
        for (size_t c = 0; c < channels_; ++c) to[m] += a[c] * b[c];
      }
      std::fill(to + shifts_.size(), to + out, 0.0F);
    }
  }

 private:
  std::vector<ptrdiff_t> shifts_;
  size_t reach_, channels_;
};

const Operation kCorrelation = {
    .model = {.name = "correlation",
              .min_inputs = 2,
              .max_inputs = 2,
              .attributes = {"shifts"},
              .shape = [](const Layer& layer, std::span<const LayerShape> inputs) -> Result<LayerShape> {
                if (!layer.attributes.contains("shifts")) {
                  return Error{ErrorCode::kInvalidValue, "no shifts; give at least one", ""};
                }
                E2LF_ASSIGN_OR_RETURN(const LayerShape input, model::equal_shapes(layer, inputs));
                return LayerShape{layer.attributes.at("shifts").size(), input.scale};
              },
              .macs =
                  [](const Layer& layer, std::span<const LayerShape> inputs) {
                    return static_cast<double>(layer.attributes.at("shifts").size() * inputs[0].channels);
                  },
              .reach = reach_of},
    .plan = [](PlanBuilder& build, const Layer& layer) -> Result<void> {
      if (build.compute() != ElementType::kFloat32) {
        return Error{ErrorCode::kUnsupported, "correlation computes in float32; use this precision", ""};
      }
      build.add(layer, std::make_unique<CorrelationKernel>(layer, build.spec(layer.inputs[0]).channels));
      return {};
    }};

Result<ReferencePlanes> correlation_reference(ReferenceCall& call) {
  const ReferencePlanes &a = *call.inputs[0], &b = *call.inputs[1];
  const auto shifts = shifts_of(call.layer);
  call.output.fill([&](size_t m, size_t y, size_t x) {
    double sum = 0.0;
    for (size_t c = 0; c < a.channels; ++c) {
      const auto from_y = static_cast<ptrdiff_t>(y) + shifts[m], from_x = static_cast<ptrdiff_t>(x) + shifts[m];
      sum += static_cast<double>(a.at(c, y, x)) * b.at_or_zero(c, from_y, from_x);
    }
    return static_cast<float>(sum);
  });
  return std::move(call.output);
}

/// A network that uses it between convolutions, at half the resolution.
model::Network correlation_network() {
  static const bool is_added =
      (add_operation(kCorrelation), added_references().emplace("correlation", correlation_reference).second);
  EXPECT_TRUE(is_added);
  Layer costs = reshape("costs", "correlation", {"a", "b"});
  costs.attributes["shifts"] = {-3, 0, 1, 5};
  return {3,
          {conv("a", "input", 20, 2, true, "", 2), conv("b", "input", 20, 2, true, "", 2), costs,
           conv("c", "costs", 7, 3), reshape("out", model::Op::kUpsample, {"c"}, 2)}};
}

TEST(AddedOperation, EqualsItsReferenceForEverySize) {
  const model::Network network = correlation_network();
  const model::Weights weights = random_weights(network, 3);
  for (const auto& [height, width] : std::vector<std::pair<size_t, size_t>>{{2, 2}, {26, 34}, {8, 4104}}) {
    const auto input = random_values(3 * height * width, 5);
    const auto expected = run_reference(network, weights, input, height, width).value();
    EXPECT_LT(largest_difference(run_engine(network, weights, input, height, width), expected), 1e-4) << width;
  }
}

TEST(AddedOperation, HasShapesCostAndReach) {
  const model::Network network = correlation_network();
  EXPECT_EQ(model::infer_shapes(network).value()[2].channels, 4U);
  // 2x2 convolutions of 3 channels, correlation and a 3x3 convolution, all of a quarter of the pixels.
  EXPECT_DOUBLE_EQ(model::macs_per_pixel(network), (2 * 20 * 3 * 4 + 4 * 20 + 7 * 4 * 9) / 4.0);
  EXPECT_EQ(model::receptive_radius(network), (5U + 1U) * 2U + 1U);
}

TEST(AddedOperation, IsReadFromAndWrittenToJson) {
  const model::Network network = correlation_network();
  const Json json = model::to_json(network);
  EXPECT_EQ(json["layers"][2]["shifts"], Json({-3, 0, 1, 5}));
  EXPECT_EQ(model::network_from_json(json, "x").value(), network);
}

TEST(AddedOperation, RefusesAttributesThatItLacksOrNeeds) {
  model::Network network = correlation_network();
  network.layers[2].attributes["stretch"] = {2};
  EXPECT_EQ(model::infer_shapes(network).error().code, ErrorCode::kInvalidValue);
  network.layers[2].attributes.clear();
  EXPECT_EQ(model::infer_shapes(network).error().location, "layer \"costs\"");
}

TEST(AddedOperation, AnOperationThatOnlyFilesKnowIsRefusedByTheEngine) {
  model::add_operation({.name = "unknown-to-engine", .shape = model::equal_shapes});
  const model::Network network{2, {reshape("a", "unknown-to-engine", {"input"})}};
  EXPECT_EQ(Engine::create(network, {}).error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace e2lf::engine
