// SPDX-License-Identifier: MIT
// Operations that remember the previous frame (Op::kConvGru, kConvLstm, kPrevious), and the tanh of their networks.
#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/model/onnx/onnx_layers.h"
#include "e2lf/video/cells.h"
#include "e2lf/video/operations.h"

namespace e2lf::video {
namespace {

using engine::ElementType, engine::Kernel, engine::PlanBuilder, engine::ReferenceCall, engine::ReferenceKernel,
    engine::ReferencePlanes, engine::TensorSpec;
using model::Layer, model::LayerShape, model::WeightShape;
using Inputs = std::span<const LayerShape>;

/// The kernel of a tensor that exists before the frame is computed; it computes nothing.
class RecallKernel final : public Kernel {
 public:
  std::string describe() const override { return "of the frame before"; }
  engine::Reach reach() const override { return {}; }
  size_t num_blocks(const engine::Strip& /*strip*/) const override { return 0; }
  void run_block(const engine::Strip& /*strip*/, size_t /*block*/, std::byte* /*scratch*/) const override {}
};

size_t num_gates(const Layer& layer) {
  return layer.op == Op::kConvGru ? 2 : 4;
}

Result<LayerShape> cell_shape(const Layer& layer, Inputs inputs) {
  const size_t most = model::kMaxChannels / 4;  // the gates have up to four times as many channels
  if (layer.out_channels > most) {
    return Error{ErrorCode::kInvalidValue, cat(layer.out_channels, " channels; use 1 to ", most), ""};
  }
  E2LF_RETURN_IF_ERROR(model::check_kernel(layer));
  return LayerShape{layer.out_channels, inputs[0].scale};
}

std::vector<WeightShape> cell_weights(const Layer& layer, Inputs inputs) {
  const size_t out = layer.out_channels, in = inputs[0].channels + out;
  auto weights = model::conv_weights(layer.name + ".gates", num_gates(layer) * out, in, layer.kernel);
  if (layer.op == Op::kConvLstm) return weights;
  for (auto& tensor : model::conv_weights(layer.name + ".candidate", out, in, layer.kernel)) {
    weights.push_back(std::move(tensor));
  }
  return weights;
}

/// Makes a convolution of a cell, from [x, h] to float32.
Result<std::unique_ptr<Kernel>> make_cell_conv(const PlanBuilder& build, const Layer& layer, const std::string& part,
                                               size_t out_channels) {
  Layer conv = layer;
  conv.op = Op::kConv;
  conv.name = cat(layer.name, ".", part);
  conv.out_channels = out_channels;
  const size_t in_channels = build.spec(layer.inputs[0]).channels + layer.out_channels;
  E2LF_ASSIGN_OR_RETURN(engine::ConvSpec spec, build.conv(conv, in_channels));
  spec.output = ElementType::kFloat32;
  return engine::make_conv(spec);
}

/// Adds the stages of a cell; see cells.h.
Result<void> plan_cell(PlanBuilder& build, const Layer& layer) {
  const TensorSpec input = build.spec(layer.inputs[0]);
  const size_t x = build.tensor(layer.inputs[0]), in = input.channels, out = layer.out_channels;
  const auto wide = [&](size_t channels) { return TensorSpec{channels, input.scale, ElementType::kFloat32}; };
  const TensorSpec joined{in + out, input.scale, build.compute()};
  const std::string part = layer.name + ".";

  const size_t before = build.add_part(part + "before", std::make_unique<RecallKernel>(), {}, wide(out));
  const size_t both = build.add_part(part + "joined", make_cell_join(in, out, build.compute()), {x, before}, joined);
  const size_t gate_channels = num_gates(layer) * out;
  E2LF_ASSIGN_OR_RETURN(auto gates_conv, make_cell_conv(build, layer, "gates", gate_channels));
  const size_t gates = build.add_part(part + "gates", std::move(gates_conv), {both}, wide(gate_channels));
  size_t result = 0;
  if (layer.op == Op::kConvGru) {
    const size_t reset =
        build.add_part(part + "reset", make_gru_reset(in, out, build.compute()), {x, before, gates}, joined);
    E2LF_ASSIGN_OR_RETURN(auto conv, make_cell_conv(build, layer, "candidate", out));
    const size_t candidate = build.add_part(part + "candidate", std::move(conv), {reset}, wide(out));
    result = build.add_part(layer.name, make_gru_blend(out), {candidate, before, gates}, wide(out));
  } else {
    const size_t memory_before =
        build.add_part(part + "memory before", std::make_unique<RecallKernel>(), {}, wide(out));
    const size_t memory = build.add_part(part + "memory", make_lstm_memory(out), {gates, memory_before}, wide(out));
    build.remember(memory_before, memory);
    result = build.add_part(layer.name, make_lstm_output(out), {gates, memory}, wide(out));
  }
  build.remember(before, result);
  const TensorSpec& output = build.spec(layer.name);
  if (output.type != ElementType::kFloat32) {
    result = build.add_part(part + "output", make_cell_output(out, output.type), {result}, output);
  }
  build.set_result(layer, result);
  return {};
}

Result<void> plan_previous(PlanBuilder& build, const Layer& layer) {
  const TensorSpec& wanted = build.spec(layer.name);
  TensorSpec kept = wanted;
  kept.type = build.output_type();
  size_t result = build.add_part(layer.name, std::make_unique<RecallKernel>(), {}, kept);
  build.remember_output(result);
  if (wanted.type != kept.type) {
    result = build.add_part(layer.name + ".output", make_cell_output(wanted.channels, wanted.type), {result}, wanted);
  }
  build.set_result(layer, result);
  return {};
}

double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

/// Concatenates x and h along the channels.
ReferencePlanes joined(const ReferencePlanes& input, const std::vector<float>& hidden) {
  ReferencePlanes both(input.channels + hidden.size() / (input.height * input.width), input.height, input.width);
  std::copy(hidden.begin(), hidden.end(), std::copy(input.values.begin(), input.values.end(), both.values.begin()));
  return both;
}

/// Returns a convolution of a cell of x and h.
Result<ReferencePlanes> cell_conv(const ReferenceCall& call, const std::string& part, size_t out_channels,
                                  const std::vector<float>& hidden) {
  const ReferencePlanes both = joined(*call.inputs[0], hidden);
  const size_t kernel = call.layer.kernel;
  E2LF_ASSIGN_OR_RETURN(
      const ReferenceKernel weights,
      call.kernel(cat(call.layer.name, ".", part), both.channels * kernel * kernel * out_channels, out_channels));
  return engine::reference_conv(both, out_channels, kernel, weights);
}

Result<ReferencePlanes> gru_reference(ReferenceCall& call) {
  const size_t out = call.layer.out_channels, size = call.output.values.size();
  std::vector<float>& hidden = call.remembered(call.layer.name, size);
  E2LF_ASSIGN_OR_RETURN(const ReferencePlanes sums, cell_conv(call, "gates", 2 * out, hidden));
  std::vector<float> reset = hidden;
  for (size_t i = 0; i < size; ++i) reset[i] = static_cast<float>(sigmoid(sums.values[size + i]) * hidden[i]);
  E2LF_ASSIGN_OR_RETURN(const ReferencePlanes wanted, cell_conv(call, "candidate", out, reset));
  for (size_t i = 0; i < size; ++i) {
    const double update = sigmoid(sums.values[i]);
    hidden[i] = static_cast<float>((1.0 - update) * hidden[i] + update * std::tanh(wanted.values[i]));
  }
  call.output.values = hidden;
  return std::move(call.output);
}

Result<ReferencePlanes> lstm_reference(ReferenceCall& call) {
  const size_t out = call.layer.out_channels, size = call.output.values.size();
  std::vector<float>& hidden = call.remembered(call.layer.name, size);
  std::vector<float>& memory = call.remembered(call.layer.name + ".memory", size);
  E2LF_ASSIGN_OR_RETURN(const ReferencePlanes sums, cell_conv(call, "gates", 4 * out, hidden));
  const auto part = [&](size_t gate, size_t i) { return static_cast<double>(sums.values[gate * size + i]); };
  for (size_t i = 0; i < size; ++i) {
    const double kept = sigmoid(part(1, i)) * memory[i], added = sigmoid(part(0, i)) * std::tanh(part(3, i));
    memory[i] = static_cast<float>(kept + added);
    hidden[i] = static_cast<float>(sigmoid(part(2, i)) * std::tanh(kept + added));
  }
  call.output.values = hidden;
  return std::move(call.output);
}

Result<void> plan_tanh(PlanBuilder& build, const Layer& layer) {
  const TensorSpec& spec = build.spec(layer.name);
  build.add(layer, make_tanh(spec.channels, spec.type));
  return {};
}

}  // namespace

engine::Operation conv_gru() {
  return {.model = {.name = Op::kConvGru,
                    .remembers = true,
                    .shape = cell_shape,
                    .weights = cell_weights,
                    .reach = [](const Layer& layer) { return 2 * (layer.kernel / 2); }},
          .plan = plan_cell,
          .reference = gru_reference,
          .has_wide_sums = true};
}

engine::Operation conv_lstm() {
  return {.model = {.name = Op::kConvLstm,
                    .remembers = true,
                    .shape = cell_shape,
                    .weights = cell_weights,
                    .reach = [](const Layer& layer) { return layer.kernel / 2; }},
          .plan = plan_cell,
          .reference = lstm_reference,
          .has_wide_sums = true};
}

engine::Operation previous_output() {
  return {.model = {.name = Op::kPrevious,
                    .min_inputs = 0,
                    .max_inputs = 0,
                    .remembers = true,
                    .is_last_output = true,
                    .shape = [](const Layer& layer, Inputs) -> Result<LayerShape> {
                      return LayerShape{layer.out_channels, 1};
                    }},
          .plan = plan_previous,
          .reference = [](ReferenceCall& call) -> Result<ReferencePlanes> {
            call.output.values = call.remembered(call.layer.name, call.output.values.size());
            return std::move(call.output);
          }};
}

engine::Operation hyperbolic_tangent() {
  return {.model = {.name = Op::kTanh,
                    .shape = model::equal_shapes,
                    .onnx = [](model::OnnxCall& call) { return call.node("Tanh"); }},
          .plan = plan_tanh,
          .reference = [](ReferenceCall& call) -> Result<ReferencePlanes> {
            const ReferencePlanes& input = *call.inputs[0];
            call.output.fill([&](size_t c, size_t y, size_t x) {
              return static_cast<float>(std::tanh(static_cast<double>(input.at(c, y, x))));
            });
            return std::move(call.output);
          }};
}

}  // namespace e2lf::video
