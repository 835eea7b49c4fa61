// SPDX-License-Identifier: MIT
#include "e2lf/engine/plan.h"

#include <algorithm>
#include <map>
#include <set>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/engine/chain.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/reshape.h"
#include "e2lf/engine/unread_layers.h"
#include "e2lf/engine/video/cells.h"
#include "e2lf/engine/video/kernels.h"

namespace e2lf::engine {
namespace {

using model::Layer;
using model::Op;

bool is_conv(const Layer& layer) {
  return layer.op == Op::kConv || layer.op == Op::kConvTransposed;
}

Result<std::vector<float>> find_weights(const model::Weights& weights, const std::string& name, size_t size) {
  const auto found = weights.find(name);
  if (found == weights.end())
    return Error{ErrorCode::kNotFound, "the weights lack " + name + "; use a complete model", ""};
  if (found->second.size() != size) {
    return Error{ErrorCode::kShape,
                 cat(name, " has ", found->second.size(), " values, the network needs ", size, "; use its own weights"),
                 ""};
  }
  return found->second;
}

class PlanMaker {
  static constexpr size_t kOutput = ~size_t{0};  ///< the last tensor, whose number is not yet known

 public:
  PlanMaker(const model::Network& network, const model::Weights& weights, ElementType compute, bool int16_products)
      : network_(network), weights_(weights), compute_(compute), int16_products_(int16_products) {}

  Result<Plan> make() {
    E2LF_ASSIGN_OR_RETURN(const auto shapes, model::infer_shapes(network_));
    specs_["input"] = {network_.input_channels, 1, compute_};
    for (size_t i = 0; i < shapes.size(); ++i) {
      specs_[network_.layers[i].name] = {shapes[i].channels, shapes[i].scale, compute_};
    }
    const std::string& last = network_.layers.back().name;
    if (can_widen(last)) widen(last);
    add_tensor("input");
    for (const Layer& layer : network_.layers) E2LF_RETURN_IF_ERROR(add_layer(layer));
    for (State& state : plan_.states) {
      if (state.kept == kOutput) state.kept = plan_.tensors.size() - 1;
    }
    measure_halo();
    return std::move(plan_);
  }

 private:
  void add_tensor(const std::string& name) {
    tensor_[name] = plan_.tensors.size();
    plan_.tensors.push_back(specs_.at(name));
  }

  /// Returns true if a layer can output float32 regardless of the type of its inputs.
  static bool has_wide_sums(const Layer& layer) { return is_conv(layer) || model::is_cell(layer); }

  size_t count_readers(const std::string& name) const {
    size_t readers = 0;
    for (const Layer& layer : network_.layers) {
      readers += static_cast<size_t>(std::count(layer.inputs.begin(), layer.inputs.end(), name));
      readers += layer.residual == name ? 1 : 0;
    }
    return readers;
  }

  const Layer* find_layer(const std::string& name) const {
    const auto found = std::find_if(network_.layers.begin(), network_.layers.end(),
                                    [&](const Layer& layer) { return layer.name == name; });
    return found == network_.layers.end() ? nullptr : &*found;
  }

  /// Returns true if a tensor can be float32 although the network computes in bfloat16. All layers that only move or
  /// add elements to make it must then be float32, too.
  bool can_widen(const std::string& name) const {
    const Layer* layer = find_layer(name);
    if (layer == nullptr) return false;
    return has_wide_sums(*layer) ||
           std::all_of(layer->inputs.begin(), layer->inputs.end(),
                       [&](const std::string& input) { return count_readers(input) == 1 && can_widen(input); });
  }

  void widen(const std::string& name) {
    specs_.at(name).type = ElementType::kFloat32;
    const Layer* layer = find_layer(name);
    if (has_wide_sums(*layer)) return;
    for (const std::string& input : layer->inputs) widen(input);
  }

  /// Returns the layer that continues a chain after `layer`, i.e. the only reader of its plain result, or null.
  const Layer* next_in_chain(const Layer& layer) const {
    const auto plain = [](const Layer& each) {
      return each.op == Op::kConv && each.stride == 1 && each.residual.empty();
    };
    if (!plain(layer) || layer.relu || count_readers(layer.name) != 1) return nullptr;
    for (const Layer& reader : network_.layers) {
      if (plain(reader) && reader.inputs[0] == layer.name) return &reader;
    }
    return nullptr;
  }

  /// Returns the only layer that reads a result, or null if there are several.
  const Layer* only_reader(const Layer& layer) const {
    if (count_readers(layer.name) != 1) return nullptr;
    for (const Layer& reader : network_.layers) {
      if (std::find(reader.inputs.begin(), reader.inputs.end(), layer.name) != reader.inputs.end()) return &reader;
    }
    return nullptr;
  }

  /// Returns true if the output channels of a convolution may be in the order in which a pixel shuffle copies them.
  bool is_shuffled(const Layer& layer) const {
    const Layer* reader = is_conv(layer) && layer.residual.empty() ? only_reader(layer) : nullptr;
    return reader != nullptr && reader->op == Op::kPixelShuffle;
  }

  /// Returns the input of a sum of two that is a convolution able to add the other input itself, or null.
  const Layer* conv_that_adds(const Layer& layer) const {
    if (layer.op != Op::kAdd || layer.inputs.size() != 2 || !layer.residual.empty()) return nullptr;
    for (size_t i = 0; i < 2; ++i) {
      const Layer* conv = find_layer(layer.inputs[i]);
      if (conv == nullptr || !is_conv(*conv) || conv->relu || only_reader(*conv) != &layer) continue;
      const Layer* before = find_layer(conv->inputs[0]);
      const bool ends_chain = before != nullptr && next_in_chain(*before) == conv;
      const bool same_type = specs_.at(layer.inputs[1 - i]).type == compute_;
      if (conv->residual.empty() && !ends_chain && same_type) return conv;
    }
    return nullptr;
  }

  Result<void> add_sum(const Layer& layer, const Layer& conv) {
    Layer whole = conv;
    whole.name = layer.name;
    whole.residual = layer.inputs[layer.inputs[0] == conv.name ? 1 : 0];
    E2LF_ASSIGN_OR_RETURN(ConvSpec spec, conv_spec(conv));
    spec.residual = true;
    spec.relu = layer.relu;
    spec.output = specs_.at(layer.name).type;
    add_stage(conv.name + "+" + layer.name, whole, make_conv(spec));
    return {};
  }

  Result<void> add_layer(const Layer& layer) {
    if (composed_.count(layer.name) > 0) return {};
    if (const Layer* conv = conv_that_adds(layer)) return add_sum(layer, *conv);
    // Such a convolution is deferred to the stage of the sum.
    if (const Layer* sum = only_reader(layer); sum != nullptr && conv_that_adds(*sum) == &layer) return {};
    if (model::is_cell(layer)) return add_cell(layer);
    if (layer.op == Op::kPrevious) {
      add_previous(layer);
      return {};
    }
    if (layer.op == Op::kLayerNorm) return add_layer_norm(layer);
    if (!is_conv(layer)) {
      add_stage(layer.name, layer, make_plain(layer));
      return {};
    }
    std::vector<const Layer*> layers = {&layer};
    while (const Layer* next = next_in_chain(*layers.back())) layers.push_back(next);
    std::vector<ConvSpec> chain;
    for (const Layer* each : layers) {
      E2LF_ASSIGN_OR_RETURN(ConvSpec spec, conv_spec(*each));
      chain.push_back(std::move(spec));
    }
    if (!worth_composing(chain)) {
      add_stage(layer.name, layer, make_conv(chain.front()));
      const bool is_head = &layer == &network_.layers.back() && layer.residual.empty();
      if (is_head) plan_.head = std::move(chain.front());
      return {};
    }
    std::string name = layer.name;
    for (size_t i = 1; i < layers.size(); ++i) {
      name += "+" + layers[i]->name;
      composed_.insert(layers[i]->name);
    }
    Layer whole = *layers.back();
    whole.inputs = layer.inputs;
    add_stage(name, whole, make_chain(chain));
    return {};
  }

  Result<void> add_layer_norm(const Layer& layer) {
    const TensorSpec& spec = specs_.at(layer.name);
    E2LF_ASSIGN_OR_RETURN(const auto weight, find_weights(weights_, layer.name + ".weight", spec.channels));
    E2LF_ASSIGN_OR_RETURN(const auto bias, find_weights(weights_, layer.name + ".bias", spec.channels));
    add_stage(layer.name, layer, make_layer_norm(weight, bias, spec.type));
    return {};
  }

  /// Makes the kernel of a layer without weights.
  std::unique_ptr<Kernel> make_plain(const Layer& layer) const {
    const ElementType type = specs_.at(layer.name).type;
    std::vector<size_t> in_channels;
    for (const std::string& input : layer.inputs) in_channels.push_back(specs_.at(input).channels);
    switch (layer.op) {
      case Op::kSigmoid:
        return make_sigmoid(in_channels[0], type);
      case Op::kTanh:
        return make_tanh(in_channels[0], type);
      case Op::kPositionCode:
        return make_position_code(in_channels[0], type);
      case Op::kAttention:
        return make_attention(in_channels[0], layer.heads, type);
      case Op::kDynamicFilter:
        return make_dynamic_filter(in_channels[0], in_channels[1], layer.kernel, type);
      case Op::kUpsampleBilinear:
        return make_bilinear(in_channels[0], layer.stride, layer.relu, type);
      case Op::kPixelUnshuffle:
      case Op::kPixelShuffle:
      case Op::kUpsample:
      case Op::kAdd:
      case Op::kMean:
      case Op::kConcat: {
        const Layer* source = find_layer(layer.inputs[0]);
        return make_reshape(layer, in_channels, type, source != nullptr && is_shuffled(*source));
      }
      case Op::kConv:
      case Op::kConvTransposed:
      case Op::kLayerNorm:
      case Op::kPrevious:
      case Op::kConvGru:
      case Op::kConvLstm:
        break;
    }
    E2LF_REQUIRE(false, "a layer with weights or memory has a function of its own");
  }

  /// Adds a stage whose result has no layer name. Returns the number of the result.
  size_t add_part(const std::string& name, std::unique_ptr<Kernel> kernel, std::vector<size_t> inputs,
                  const TensorSpec& spec) {
    Stage stage;
    stage.name = name;
    stage.kernel = std::move(kernel);
    stage.inputs = std::move(inputs);
    plan_.stages.push_back(std::move(stage));
    plan_.tensors.push_back(spec);
    return plan_.tensors.size() - 1;
  }

  /// Makes a convolution of a cell, from [x, h] to float32.
  Result<std::unique_ptr<Kernel>> make_cell_conv(const Layer& layer, const std::string& part, size_t out_channels) {
    Layer conv = layer;
    conv.op = Op::kConv;
    conv.name = cat(layer.name, ".", part);
    conv.out_channels = out_channels;
    E2LF_ASSIGN_OR_RETURN(ConvSpec spec, conv_spec(conv, specs_.at(layer.inputs[0]).channels + layer.out_channels));
    spec.output = ElementType::kFloat32;
    return make_conv(spec);
  }

  /// Adds the stages of a cell; see cells.h.
  Result<void> add_cell(const Layer& layer) {
    const TensorSpec input = specs_.at(layer.inputs[0]);
    const size_t x = tensor_.at(layer.inputs[0]), in = input.channels, out = layer.out_channels;
    const bool is_gru = layer.op == Op::kConvGru;
    const auto wide = [&](size_t channels) { return TensorSpec{channels, input.scale, ElementType::kFloat32}; };
    const TensorSpec joined{in + out, input.scale, compute_};
    const std::string part = layer.name + ".";

    const size_t before = add_part(part + "before", make_recall(), {}, wide(out));
    const size_t both = add_part(part + "joined", make_cell_join(in, out, compute_), {x, before}, joined);
    const size_t num_gates = (is_gru ? 2 : 4) * out;
    E2LF_ASSIGN_OR_RETURN(auto gates_conv, make_cell_conv(layer, "gates", num_gates));
    const size_t gates = add_part(part + "gates", std::move(gates_conv), {both}, wide(num_gates));
    size_t result = 0;
    if (is_gru) {
      const size_t reset = add_part(part + "reset", make_gru_reset(in, out, compute_), {x, before, gates}, joined);
      E2LF_ASSIGN_OR_RETURN(auto conv, make_cell_conv(layer, "candidate", out));
      const size_t candidate = add_part(part + "candidate", std::move(conv), {reset}, wide(out));
      result = add_part(layer.name, make_gru_blend(out), {candidate, before, gates}, wide(out));
    } else {
      const size_t memory_before = add_part(part + "memory before", make_recall(), {}, wide(out));
      const size_t memory = add_part(part + "memory", make_lstm_memory(out), {gates, memory_before}, wide(out));
      plan_.states.push_back({memory_before, memory});
      result = add_part(layer.name, make_lstm_output(out), {gates, memory}, wide(out));
    }
    plan_.states.push_back({before, result});
    const TensorSpec& output = specs_.at(layer.name);
    if (output.type != ElementType::kFloat32) {
      result = add_part(part + "output", make_cell_output(out, output.type), {result}, output);
    }
    tensor_[layer.name] = result;
    return {};
  }

  /// Adds the output of the previous frame.
  void add_previous(const Layer& layer) {
    const TensorSpec& wanted = specs_.at(layer.name);
    TensorSpec kept = wanted;
    kept.type = specs_.at(network_.layers.back().name).type;
    size_t result = add_part(layer.name, make_recall(), {}, kept);
    plan_.states.push_back({result, kOutput});
    if (wanted.type != kept.type) {
      result = add_part(layer.name + ".output", make_cell_output(wanted.channels, wanted.type), {result}, wanted);
    }
    tensor_[layer.name] = result;
  }

  /// Adds a stage. `layer` gives the name of the result and of its inputs.
  void add_stage(const std::string& name, const Layer& layer, std::unique_ptr<Kernel> kernel) {
    Stage stage;
    stage.name = name;
    stage.kernel = std::move(kernel);
    for (const std::string& input : layer.inputs) stage.inputs.push_back(tensor_.at(input));
    if (!layer.residual.empty()) stage.residual = tensor_.at(layer.residual);
    plan_.stages.push_back(std::move(stage));
    add_tensor(layer.name);
  }

  Result<ConvSpec> conv_spec(const Layer& layer) const {
    E2LF_ASSIGN_OR_RETURN(ConvSpec spec, conv_spec(layer, specs_.at(layer.inputs[0]).channels));
    spec.output = specs_.at(layer.name).type;
    if (is_shuffled(layer)) put_phases_first(only_reader(layer)->stride, spec);
    return spec;
  }

  Result<ConvSpec> conv_spec(const Layer& layer, size_t in_channels) const {
    ConvSpec spec;
    spec.in_channels = in_channels;
    spec.out_channels = layer.out_channels;
    spec.kernel = layer.kernel;
    spec.stride = layer.stride;
    spec.transposed = layer.op == Op::kConvTransposed;
    spec.relu = layer.relu;
    spec.residual = !layer.residual.empty();
    spec.compute = compute_;
    spec.int16_products = int16_products_;
    const size_t taps = layer.kernel * layer.kernel;
    E2LF_ASSIGN_OR_RETURN(spec.weight,
                          find_weights(weights_, layer.name + ".weight", taps * spec.in_channels * spec.out_channels));
    E2LF_ASSIGN_OR_RETURN(spec.bias, find_weights(weights_, layer.name + ".bias", spec.out_channels));
    if (spec.transposed) {
      const std::vector<float> in_first = spec.weight;
      for (size_t out = 0; out < spec.out_channels; ++out) {
        for (size_t in = 0; in < spec.in_channels; ++in) {
          std::copy_n(&in_first[(in * spec.out_channels + out) * taps], taps,
                      &spec.weight[(out * spec.in_channels + in) * taps]);
        }
      }
    }
    return spec;
  }

  /// Reorders output channels from the order [channel, phase] of a pixel shuffle to [phase, channel].
  static void put_phases_first(size_t stride, ConvSpec& spec) {
    const size_t phases = stride * stride, channels = spec.out_channels / phases;
    const size_t length = spec.weight.size() / spec.out_channels;
    const ConvSpec original = spec;
    for (size_t out = 0; out < spec.out_channels; ++out) {
      const size_t from = out % channels * phases + out / channels;
      spec.bias[out] = original.bias[from];
      std::copy_n(&original.weight[from * length], length, &spec.weight[out * length]);
    }
  }

  void measure_halo() {
    std::vector<size_t> halo(plan_.tensors.size(), 0);
    for (size_t i = 0; i < plan_.stages.size(); ++i) {
      const Stage& stage = plan_.stages[i];
      const Reach reach = stage.kernel->reach();
      plan_.needs_whole_rows |= stage.kernel->needs_whole_rows();
      for (const size_t input : stage.inputs) {
        const size_t own = std::max(reach.before, reach.after) * plan_.tensors[input].scale;
        // A coarse pixel that depends on pixels affected by a cut is affected as a whole.
        halo[i + 1] = std::max(halo[i + 1], round_up(halo[input] + own, plan_.tensors[i + 1].scale));
      }
      if (stage.residual) halo[i + 1] = std::max(halo[i + 1], halo[*stage.residual]);
    }
    plan_.alignment = model::size_multiple(network_) * kTileSize;
    plan_.halo = round_up(halo.back(), plan_.alignment);
  }

  const model::Network& network_;
  const model::Weights& weights_;
  ElementType compute_;
  bool int16_products_;
  Plan plan_;
  std::map<std::string, TensorSpec> specs_;  ///< of the result of every layer
  std::map<std::string, size_t> tensor_;     ///< number in the plan
  std::set<std::string> composed_;           ///< layers that are part of an earlier stage
};

}  // namespace

std::vector<size_t> Stage::reads() const {
  std::vector<size_t> all = inputs;
  if (residual) all.push_back(*residual);
  return all;
}

Result<Plan> make_plan(const model::Network& network, const model::Weights& weights, ElementType compute,
                       bool int16_products) {
  if (const auto shapes = model::infer_shapes(network); !shapes) return shapes.error();
  const model::Network read = without_unread_layers(network);
  return PlanMaker(read, weights, compute, int16_products).make();
}

Plan with_outputs(const Plan& plan, std::span<const size_t> channels) {
  E2LF_REQUIRE(plan.head && plan.states.empty(), "only a last convolution gives some channels alone");
  Plan some = plan;
  ConvSpec& head = *some.head;
  const size_t length = head.weight.size() / head.out_channels;
  head.out_channels = channels.size();
  head.weight.clear();
  head.bias.clear();
  for (const size_t channel : channels) {
    E2LF_REQUIRE(channel < plan.head->out_channels, "the network has no such output");
    const float* const weight = plan.head->weight.data() + channel * length;
    head.weight.insert(head.weight.end(), weight, weight + length);
    head.bias.push_back(plan.head->bias[channel]);
  }
  some.stages.back().kernel = make_conv(head);
  some.tensors.back().channels = channels.size();
  return some;
}

}  // namespace e2lf::engine
