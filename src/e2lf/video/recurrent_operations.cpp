// SPDX-License-Identifier: MIT
// Operations that remember the previous frame (VideoOp::kConvGru, kConvLstm, kPrevious), and the tanh of their
// networks.
#include <algorithm>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/engine/conv.h"
#include "e2lf/model/onnx/onnx_export.h"
#include "e2lf/video/operations.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/video/recurrent_operations.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/pixel_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::video {
namespace HWY_NAMESPACE {
namespace {

using namespace engine::HWY_NAMESPACE;
using namespace engine;
using model::Layer;

// The functions that kernels apply to kLanes channels of a pixel. The arguments are the elements of their inputs from
// the first of these channels on; `part` is the number of channels from one gate to the next.

struct TanhOf {
  template <class Element>
  HWY_INLINE FloatVec operator()(const Element* x) const {
    return tanh(load_floats(x));
  }
};

struct Copy {
  template <class Element>
  HWY_INLINE FloatVec operator()(const Element* x) const {
    return load_floats(x);
  }
};

struct Reset {
  size_t part;
  HWY_INLINE FloatVec operator()(const float* state, const float* gates) const {
    return hn::Mul(sigmoid(load_floats(gates + part)), load_floats(state));
  }
};

struct Blend {
  HWY_INLINE FloatVec operator()(const float* candidate, const float* state, const float* gates) const {
    const auto before = load_floats(state);
    return hn::MulAdd(sigmoid(load_floats(gates)), hn::Sub(tanh(load_floats(candidate)), before), before);
  }
};

struct LstmMemory {
  size_t part;
  HWY_INLINE FloatVec operator()(const float* gates, const float* state) const {
    const auto added = hn::Mul(sigmoid(load_floats(gates)), tanh(load_floats(gates + 3 * part)));
    return hn::MulAdd(sigmoid(load_floats(gates + part)), load_floats(state), added);
  }
};

struct LstmOutput {
  size_t part;
  HWY_INLINE FloatVec operator()(const float* gates, const float* memory) const {
    return hn::Mul(sigmoid(load_floats(gates + 2 * part)), tanh(load_floats(memory)));
  }
};

/// The kernel of a tensor that exists before the frame is computed; it computes nothing.
class RecallKernel final : public Kernel {
 public:
  std::string describe() const override { return "of the frame before"; }
  size_t num_blocks(const Strip& /*strip*/) const override { return 0; }
  void run_block(const Strip& /*strip*/, size_t /*block*/, std::byte* /*scratch*/) const override {}
};

// The kernels of recurrent cells between their convolutions, pixel by pixel; one block is one row. The states of a cell
// and the sums of its convolutions are float32, because small changes would be lost in bfloat16. The inputs of its
// convolutions have the type in which these compute.

/// Input `index` of a kernel, which has this many channels in float32.
Source<float> source(size_t index, size_t channels) {
  return {index, padded_channels(channels)};
}

/// x, h' -> [x, h'] with the output type `type`, which is also that of x.
std::unique_ptr<Kernel> make_join(size_t in_channels, size_t channels, ElementType type) {
  return for_element(type, [&](auto element) {
    return make_kernel<decltype(element)>("join", channels, in_channels, Copy{}, source(1, channels));
  });
}

/// x, h', (u, r) before their sigmoid -> [x, sigmoid(r) h'] with the output type `type`, which is also that of x.
std::unique_ptr<Kernel> make_reset(size_t in_channels, size_t channels, ElementType type) {
  return for_element(type, [&](auto element) {
    return make_kernel<decltype(element)>("GRU reset", channels, in_channels, Reset{channels}, source(1, channels),
                                          source(2, 2 * channels));
  });
}

/// o before its tanh, h', (u, r) before their sigmoid -> h = h' + sigmoid(u) (tanh(o) - h').
std::unique_ptr<Kernel> make_blend(size_t channels) {
  return make_kernel<float>("GRU blend", channels, 0, Blend{}, source(0, channels), source(1, channels),
                            source(2, 2 * channels));
}

/// (i, f, o, g) before their sigmoid and tanh, c' -> c = sigmoid(f) c' + sigmoid(i) tanh(g).
std::unique_ptr<Kernel> make_lstm_memory(size_t channels) {
  return make_kernel<float>("LSTM memory", channels, 0, LstmMemory{channels}, source(0, 4 * channels),
                            source(1, channels));
}

/// (i, f, o, g) as above, c -> h = sigmoid(o) tanh(c).
std::unique_ptr<Kernel> make_lstm_output(size_t channels) {
  return make_kernel<float>("LSTM output", channels, 0, LstmOutput{channels}, source(0, 4 * channels),
                            source(1, channels));
}

/// Makes a convolution of a cell, from [x, h] to float32.
Result<std::unique_ptr<Kernel>> make_cell_conv(const PlanBuilder& build, const Layer& layer, const std::string& part,
                                               size_t out_channels) {
  Layer conv = layer;
  conv.op = VideoOp::kConv;
  conv.name = cat(layer.name, ".", part);
  conv.out_channels = out_channels;
  const size_t in_channels = build.spec(layer.inputs[0]).channels + layer.out_channels;
  E2LF_ASSIGN_OR_RETURN(ConvSpec spec, build.conv(conv, in_channels));
  spec.output = ElementType::kFloat32;
  return make_conv(spec);
}

/// Declares a tensor to be the result of a layer, after converting float32 to the type of the layer.
void set_result(PlanBuilder& build, const Layer& layer, size_t result, const TensorSpec& spec) {
  const TensorSpec& wanted = build.spec(layer.name);
  if (spec.type != wanted.type) {
    auto kernel = for_element(wanted.type, [&](auto element) {
      return make_kernel<decltype(element)>("round", wanted.channels, 0, Copy{}, source(0, wanted.channels));
    });
    result = build.add_part(layer.name + ".output", std::move(kernel), {result}, wanted);
  }
  build.set_result(layer, result);
}

}  // namespace

Result<void> PlanCell(PlanBuilder& build, const Layer& layer) {
  const TensorSpec input = build.spec(layer.inputs[0]);
  const size_t x = build.tensor(layer.inputs[0]), in = input.channels, out = layer.out_channels;
  const auto wide = [&](size_t channels) { return TensorSpec{channels, input.scale, ElementType::kFloat32}; };
  const TensorSpec joined{in + out, input.scale, build.compute()};
  const std::string part = layer.name + ".";

  const size_t before = build.add_part(part + "before", std::make_unique<RecallKernel>(), {}, wide(out));
  const size_t both = build.add_part(part + "joined", make_join(in, out, build.compute()), {x, before}, joined);
  const size_t gate_channels = (layer.op == VideoOp::kConvGru ? 2 : 4) * out;
  E2LF_ASSIGN_OR_RETURN(auto gates_conv, make_cell_conv(build, layer, "gates", gate_channels));
  const size_t gates = build.add_part(part + "gates", std::move(gates_conv), {both}, wide(gate_channels));
  size_t result = 0;
  if (layer.op == VideoOp::kConvGru) {
    const size_t reset =
        build.add_part(part + "reset", make_reset(in, out, build.compute()), {x, before, gates}, joined);
    E2LF_ASSIGN_OR_RETURN(auto conv, make_cell_conv(build, layer, "candidate", out));
    const size_t candidate = build.add_part(part + "candidate", std::move(conv), {reset}, wide(out));
    result = build.add_part(layer.name, make_blend(out), {candidate, before, gates}, wide(out));
  } else {
    const size_t memory_before =
        build.add_part(part + "memory before", std::make_unique<RecallKernel>(), {}, wide(out));
    const size_t memory = build.add_part(part + "memory", make_lstm_memory(out), {gates, memory_before}, wide(out));
    build.remember(memory_before, memory);
    result = build.add_part(layer.name, make_lstm_output(out), {gates, memory}, wide(out));
  }
  build.remember(before, result);
  set_result(build, layer, result, wide(out));
  return {};
}

Result<void> PlanPrevious(PlanBuilder& build, const Layer& layer) {
  TensorSpec kept = build.spec(layer.name);
  kept.type = build.output_type();
  const size_t result = build.add_part(layer.name, std::make_unique<RecallKernel>(), {}, kept);
  build.remember_output(result);
  set_result(build, layer, result, kept);
  return {};
}

Result<void> PlanTanh(PlanBuilder& build, const Layer& layer) {
  const TensorSpec& spec = build.spec(layer.name);
  build.add(layer, one_to_one<TanhOf>("tanh", spec.channels, spec.type));
  return {};
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::video
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::video {

HWY_EXPORT(PlanCell);
HWY_EXPORT(PlanPrevious);
HWY_EXPORT(PlanTanh);

namespace {

using engine::PlanBuilder;
using model::Layer, model::LayerShape, model::WeightShape;
using Inputs = std::span<const LayerShape>;

Result<LayerShape> cell_shape(const Layer& layer, Inputs inputs) {
  const size_t most = model::kMaxChannels / 4;  // the gates have up to four times as many channels
  if (layer.out_channels > most) {
    return fail(ErrorCode::kInvalidValue, "", layer.out_channels, " channels; use 1 to ", most);
  }
  E2LF_RETURN_IF_ERROR(model::check_kernel(layer));
  return LayerShape{layer.out_channels, inputs[0].scale};
}

std::vector<WeightShape> cell_weights(const Layer& layer, Inputs inputs) {
  const size_t out = layer.out_channels, in = inputs[0].channels + out, gates = layer.op == VideoOp::kConvGru ? 2 : 4;
  auto weights = model::conv_weights(layer.name + ".gates", gates * out, in, layer.kernel);
  if (layer.op == VideoOp::kConvLstm) return weights;
  for (auto& tensor : model::conv_weights(layer.name + ".candidate", out, in, layer.kernel)) {
    weights.push_back(std::move(tensor));
  }
  return weights;
}

Result<void> plan_cell(PlanBuilder& build, const Layer& layer) {
  return HWY_DYNAMIC_DISPATCH(PlanCell)(build, layer);
}

engine::Operation cell(const char* name, size_t (*reach)(const Layer& layer)) {
  return {.model = {.name = name, .remembers = true, .shape = cell_shape, .weights = cell_weights, .reach = reach},
          .plan = plan_cell,
          .has_wide_sums = true};
}

}  // namespace

engine::Operation conv_gru() {
  return cell(VideoOp::kConvGru, [](const Layer& layer) { return 2 * (layer.kernel / 2); });
}

engine::Operation conv_lstm() {
  return cell(VideoOp::kConvLstm, [](const Layer& layer) { return layer.kernel / 2; });
}

engine::Operation previous_output() {
  return {
      .model = {.name = VideoOp::kPrevious,
                .min_inputs = 0,
                .max_inputs = 0,
                .remembers = true,
                .is_last_output = true,
                .shape = [](const Layer& layer, Inputs) -> Result<LayerShape> {
                  return LayerShape{layer.out_channels, 1};
                }},
      .plan = [](PlanBuilder& build, const Layer& layer) { return HWY_DYNAMIC_DISPATCH(PlanPrevious)(build, layer); }};
}

engine::Operation hyperbolic_tangent() {
  return {.model = {.name = VideoOp::kTanh,
                    .shape = model::equal_shapes,
                    .onnx = [](model::OnnxCall& call) { return call.node("Tanh"); }},
          .plan = [](PlanBuilder& build, const Layer& layer) { return HWY_DYNAMIC_DISPATCH(PlanTanh)(build, layer); }};
}

}  // namespace e2lf::video
#endif
