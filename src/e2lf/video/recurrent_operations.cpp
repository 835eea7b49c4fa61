// SPDX-License-Identifier: MIT
// Operations that remember the previous frame (Op::kConvGru, kConvLstm, kPrevious), and the tanh of their networks.
#include <algorithm>
#include <cmath>

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

}  // namespace

// The kernels of recurrent cells between their convolutions, pixel by pixel; one block is one row. The states of a cell
// and the sums of its convolutions are float32, because small changes would be lost in bfloat16. The inputs of its
// convolutions have the type in which these compute.

/// x, h' -> [x, h'] with the output type `type`, which is also that of x.
std::unique_ptr<Kernel> MakeJoin(size_t in_channels, size_t channels, ElementType type) {
  return for_element(type, [&](auto element) {
    return make_kernel<decltype(element)>("join", channels, in_channels, Copy{},
                                          Source<float>{1, padded_channels(channels)});
  });
}

/// x, h', (u, r) before their sigmoid -> [x, sigmoid(r) h'] with the output type `type`, which is also that of x.
std::unique_ptr<Kernel> MakeReset(size_t in_channels, size_t channels, ElementType type) {
  return for_element(type, [&](auto element) {
    return make_kernel<decltype(element)>("GRU reset", channels, in_channels, Reset{channels},
                                          Source<float>{1, padded_channels(channels)},
                                          Source<float>{2, padded_channels(2 * channels)});
  });
}

/// o before its tanh, h', (u, r) before their sigmoid -> h = h' + sigmoid(u) (tanh(o) - h').
std::unique_ptr<Kernel> MakeBlend(size_t channels) {
  const size_t step = padded_channels(channels);
  return make_kernel<float>("GRU blend", channels, 0, Blend{}, Source<float>{0, step}, Source<float>{1, step},
                            Source<float>{2, padded_channels(2 * channels)});
}

/// (i, f, o, g) before their sigmoid and tanh, c' -> c = sigmoid(f) c' + sigmoid(i) tanh(g).
std::unique_ptr<Kernel> MakeLstmMemory(size_t channels) {
  return make_kernel<float>("LSTM memory", channels, 0, LstmMemory{channels},
                            Source<float>{0, padded_channels(4 * channels)},
                            Source<float>{1, padded_channels(channels)});
}

/// (i, f, o, g) as above, c -> h = sigmoid(o) tanh(c).
std::unique_ptr<Kernel> MakeLstmOutput(size_t channels) {
  return make_kernel<float>("LSTM output", channels, 0, LstmOutput{channels},
                            Source<float>{0, padded_channels(4 * channels)},
                            Source<float>{1, padded_channels(channels)});
}

/// Converts float32 to `type`.
std::unique_ptr<Kernel> MakeCellOutput(size_t channels, ElementType type) {
  return for_element(type, [&](auto element) {
    return make_kernel<decltype(element)>("round", channels, 0, Copy{}, Source<float>{0, padded_channels(channels)});
  });
}

std::unique_ptr<Kernel> MakeTanh(size_t channels, ElementType type) {
  return one_to_one<TanhOf>("tanh", channels, type);
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::video
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::video {

HWY_EXPORT(MakeJoin);
HWY_EXPORT(MakeReset);
HWY_EXPORT(MakeBlend);
HWY_EXPORT(MakeLstmMemory);
HWY_EXPORT(MakeLstmOutput);
HWY_EXPORT(MakeCellOutput);
HWY_EXPORT(MakeTanh);

namespace {

using engine::ElementType, engine::Kernel, engine::PlanBuilder, engine::TensorSpec;
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
    return fail(ErrorCode::kInvalidValue, "", layer.out_channels, " channels; use 1 to ", most);
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

/// Adds the stages of a cell.
Result<void> plan_cell(PlanBuilder& build, const Layer& layer) {
  const TensorSpec input = build.spec(layer.inputs[0]);
  const size_t x = build.tensor(layer.inputs[0]), in = input.channels, out = layer.out_channels;
  const auto wide = [&](size_t channels) { return TensorSpec{channels, input.scale, ElementType::kFloat32}; };
  const TensorSpec joined{in + out, input.scale, build.compute()};
  const std::string part = layer.name + ".";

  const size_t before = build.add_part(part + "before", std::make_unique<RecallKernel>(), {}, wide(out));
  const size_t both =
      build.add_part(part + "joined", HWY_DYNAMIC_DISPATCH(MakeJoin)(in, out, build.compute()), {x, before}, joined);
  const size_t gate_channels = num_gates(layer) * out;
  E2LF_ASSIGN_OR_RETURN(auto gates_conv, make_cell_conv(build, layer, "gates", gate_channels));
  const size_t gates = build.add_part(part + "gates", std::move(gates_conv), {both}, wide(gate_channels));
  size_t result = 0;
  if (layer.op == Op::kConvGru) {
    const size_t reset = build.add_part(part + "reset", HWY_DYNAMIC_DISPATCH(MakeReset)(in, out, build.compute()),
                                        {x, before, gates}, joined);
    E2LF_ASSIGN_OR_RETURN(auto conv, make_cell_conv(build, layer, "candidate", out));
    const size_t candidate = build.add_part(part + "candidate", std::move(conv), {reset}, wide(out));
    result = build.add_part(layer.name, HWY_DYNAMIC_DISPATCH(MakeBlend)(out), {candidate, before, gates}, wide(out));
  } else {
    const size_t memory_before =
        build.add_part(part + "memory before", std::make_unique<RecallKernel>(), {}, wide(out));
    const size_t memory =
        build.add_part(part + "memory", HWY_DYNAMIC_DISPATCH(MakeLstmMemory)(out), {gates, memory_before}, wide(out));
    build.remember(memory_before, memory);
    result = build.add_part(layer.name, HWY_DYNAMIC_DISPATCH(MakeLstmOutput)(out), {gates, memory}, wide(out));
  }
  build.remember(before, result);
  const TensorSpec& output = build.spec(layer.name);
  if (output.type != ElementType::kFloat32) {
    result = build.add_part(part + "output", HWY_DYNAMIC_DISPATCH(MakeCellOutput)(out, output.type), {result}, output);
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
    result = build.add_part(layer.name + ".output", HWY_DYNAMIC_DISPATCH(MakeCellOutput)(wanted.channels, wanted.type),
                            {result}, wanted);
  }
  build.set_result(layer, result);
  return {};
}

Result<void> plan_tanh(PlanBuilder& build, const Layer& layer) {
  const TensorSpec& spec = build.spec(layer.name);
  build.add(layer, HWY_DYNAMIC_DISPATCH(MakeTanh)(spec.channels, spec.type));
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
          .has_wide_sums = true};
}

engine::Operation conv_lstm() {
  return {.model = {.name = Op::kConvLstm,
                    .remembers = true,
                    .shape = cell_shape,
                    .weights = cell_weights,
                    .reach = [](const Layer& layer) { return layer.kernel / 2; }},
          .plan = plan_cell,
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
          .plan = plan_previous};
}

engine::Operation hyperbolic_tangent() {
  return {.model = {.name = Op::kTanh,
                    .shape = model::equal_shapes,
                    .onnx = [](model::OnnxCall& call) { return call.node("Tanh"); }},
          .plan = plan_tanh};
}

}  // namespace e2lf::video
#endif
