// SPDX-License-Identifier: MIT
#include "e2lf/engine/plan.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <numeric>
#include <set>

#include "e2lf/base/text.h"
#include "e2lf/engine/operation.h"
#include "e2lf/engine/reshape.h"
#include "e2lf/model/model_parts.h"

namespace e2lf::engine {
namespace {

using model::Layer;
using model::Op;

bool is_conv(const Layer& layer) {
  return layer.op == Op::kConv || layer.op == Op::kConvTransposed;
}

/// Returns the network without the layers on which the output does not depend. Rows of a tensor without readers would
/// never be released, nor would those from which they are computed.
model::Network without_unread_layers(const model::Network& network) {
  std::set<std::string> read = {network.layers.back().name};
  model::Network result{network.input_channels, {}};
  for (size_t i = network.layers.size(); i-- > 0;) {
    const Layer& layer = network.layers[i];
    if (!read.contains(layer.name)) continue;
    read.insert(layer.inputs.begin(), layer.inputs.end());
    read.insert(layer.residual);
    result.layers.insert(result.layers.begin(), layer);
  }
  return result;
}

class PlanMaker {
 public:
  PlanMaker(const model::Network& network, const model::Weights& weights, ElementType compute, bool int16_products)
      : network_(network),
        build_(weights, tensor_specs(compute), network.layers.back().name, compute, int16_products) {}

  Result<Plan> make() {
    for (const Layer& layer : network_.layers) E2LF_RETURN_IF_ERROR(add_layer(layer));
    return build_.finish(std::move(head_));
  }

 private:
  std::map<std::string, TensorSpec> tensor_specs(ElementType compute) const {
    const std::vector<model::LayerShape> shapes = model::infer_shapes(network_).value();
    std::map<std::string, TensorSpec> specs = {{"input", {network_.input_channels, 1, compute}}};
    for (size_t i = 0; i < shapes.size(); ++i) {
      specs[network_.layers[i].name] = {shapes[i].channels, shapes[i].scale, compute};
    }
    const std::string& last = network_.layers.back().name;
    if (can_widen(last)) widen(last, specs);
    return specs;
  }

  /// Returns true if a layer can output float32 regardless of the type of its inputs.
  static bool has_wide_sums(const Layer& layer) {
    const Operation* const operation = find_operation(layer.op);
    return is_conv(layer) || (operation != nullptr && operation->has_wide_sums);
  }

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

  void widen(const std::string& name, std::map<std::string, TensorSpec>& specs) const {
    specs.at(name).type = ElementType::kFloat32;
    const Layer* layer = find_layer(name);
    if (has_wide_sums(*layer)) return;
    for (const std::string& input : layer->inputs) widen(input, specs);
  }

  /// Returns the layer that continues a chain after `layer`, i.e. the only reader of its plain result, or null.
  const Layer* next_in_chain(const Layer& layer) const {
    const auto plain = [](const Layer& each) {
      return each.op == Op::kConv && each.stride == 1 && each.residual.empty();
    };
    const Layer* reader = plain(layer) && !layer.relu ? only_reader(layer) : nullptr;
    return reader != nullptr && plain(*reader) ? reader : nullptr;
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
      const bool same_type = build_.spec(layer.inputs[1 - i]).type == build_.compute();
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
    spec.output = build_.spec(layer.name).type;
    build_.add(whole, make_conv(spec), conv.name + "+" + layer.name);
    return {};
  }

  Result<void> add_layer(const Layer& layer) {
    if (composed_.count(layer.name) > 0) return {};
    if (const Layer* conv = conv_that_adds(layer)) return add_sum(layer, *conv);
    // Such a convolution is deferred to the stage of the sum.
    if (const Layer* sum = only_reader(layer); sum != nullptr && conv_that_adds(*sum) == &layer) return {};
    if (const Operation* const operation = find_operation(layer.op)) return operation->plan(build_, layer);
    if (!is_conv(layer)) return add_plain(layer);
    std::vector<const Layer*> layers = {&layer};
    while (const Layer* next = next_in_chain(*layers.back())) layers.push_back(next);
    std::vector<ConvSpec> chain;
    for (const Layer* each : layers) {
      E2LF_ASSIGN_OR_RETURN(ConvSpec spec, conv_spec(*each));
      chain.push_back(std::move(spec));
    }
    if (!worth_composing(chain)) {
      build_.add(layer, make_conv(chain.front()));
      const bool is_head = &layer == &network_.layers.back() && layer.residual.empty();
      if (is_head) head_ = std::move(chain.front());
      return {};
    }
    std::string name = layer.name;
    for (size_t i = 1; i < layers.size(); ++i) {
      name += "+" + layers[i]->name;
      composed_.insert(layers[i]->name);
    }
    Layer whole = *layers.back();
    whole.inputs = layer.inputs;
    build_.add(whole, make_chain(chain), name);
    return {};
  }

  /// Adds a layer without weights.
  Result<void> add_plain(const Layer& layer) {
    const TensorSpec& output = build_.spec(layer.name);
    std::vector<size_t> in_channels;
    for (const std::string& input : layer.inputs) in_channels.push_back(build_.spec(input).channels);
    if (layer.op == Op::kSigmoid) {
      build_.add(layer, make_sigmoid(in_channels[0], output.type));
      return {};
    }
    if (!is_reshape(layer)) {
      return fail(ErrorCode::kUnsupported, cat("layer \"", layer.name, "\""),
                  "the engine does not compute the operation ", layer.op, "; add it with engine::add_operation()");
    }
    const Layer* source = find_layer(layer.inputs[0]);
    build_.add(layer, make_reshape(layer, in_channels, output, source != nullptr && is_shuffled(*source)));
    return {};
  }

  Result<ConvSpec> conv_spec(const Layer& layer) const {
    E2LF_ASSIGN_OR_RETURN(ConvSpec spec, build_.conv(layer, build_.spec(layer.inputs[0]).channels));
    spec.output = build_.spec(layer.name).type;
    if (is_shuffled(layer)) put_phases_first(only_reader(layer)->stride, spec);
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

  const model::Network& network_;
  PlanBuilder build_;
  std::optional<ConvSpec> head_;
  std::set<std::string> composed_;  ///< layers that are part of an earlier stage
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
  E2LF_RETURN_IF_ERROR(model::validate_weights(network, weights, "weights"));
  const model::Network read = without_unread_layers(network);
  return PlanMaker(read, weights, compute, int16_products).make();
}

std::optional<Plan> with_outputs(const Plan& plan, std::span<const size_t> channels) {
  E2LF_REQUIRE(plan.states.empty(), "the next frame needs all channels");
  E2LF_REQUIRE(std::ranges::all_of(channels, [&](size_t channel) { return channel < plan.tensors.back().channels; }),
               "the network has no such output");
  Plan some = plan;
  some.tensors.back().channels = channels.size();
  if (!plan.head) {
    some.stages.back().kernel = plan.stages.back().kernel->with_outputs(channels);
    return some.stages.back().kernel ? std::optional(std::move(some)) : std::nullopt;
  }
  ConvSpec& head = *some.head;
  const size_t length = head.weight.size() / head.out_channels;
  head.out_channels = channels.size();
  head.weight.clear();
  head.bias.clear();
  for (const size_t channel : channels) {
    const float* const weight = plan.head->weight.data() + channel * length;
    head.weight.insert(head.weight.end(), weight, weight + length);
    head.bias.push_back(plan.head->bias[channel]);
  }
  some.stages.back().kernel = make_conv(head);
  return some;
}

namespace {

/// The operations by name. Pointers to the elements of a map stay valid.
struct Registry {
  std::mutex mutex;
  std::map<std::string, Operation> operations;
};

Registry& registry() {
  static Registry instance;
  return instance;
}

}  // namespace

void add_operation(const Operation& operation) {
  E2LF_REQUIRE(operation.plan != nullptr, "the engine cannot compute it");
  model::add_operation(operation.model);
  const std::scoped_lock lock(registry().mutex);
  registry().operations.emplace(operation.model.name, operation);
}

const Operation* find_operation(const std::string& name) {
  const std::scoped_lock lock(registry().mutex);
  const auto found = registry().operations.find(name);
  return found == registry().operations.end() ? nullptr : &found->second;
}

PlanBuilder::PlanBuilder(const model::Weights& weights, std::map<std::string, TensorSpec> specs,
                         const std::string& output, ElementType compute, bool int16_products)
    : weights_(weights),
      compute_(compute),
      output_type_(specs.at(output).type),
      int16_products_(int16_products),
      specs_(std::move(specs)) {
  tensor_["input"] = 0;
  plan_.tensors.push_back(spec("input"));
}

Result<std::vector<float>> PlanBuilder::weights(const std::string& name, size_t size) const {
  const auto found = weights_.find(name);
  if (found != weights_.end() && found->second.size() == size) return found->second;
  return fail(ErrorCode::kShape, "", "the network has no ", size, " weights ", name, "; its operation must state them");
}

Result<ConvSpec> PlanBuilder::conv(const model::Layer& layer, size_t in_channels) const {
  ConvSpec spec;
  spec.in_channels = in_channels;
  spec.out_channels = layer.out_channels;
  spec.kernel = layer.kernel;
  spec.stride = layer.stride;
  spec.transposed = layer.op == model::Op::kConvTransposed;
  spec.relu = layer.relu;
  spec.residual = !layer.residual.empty();
  spec.compute = spec.output = compute_;
  spec.int16_products = int16_products_;
  const size_t taps = layer.kernel * layer.kernel;
  E2LF_ASSIGN_OR_RETURN(spec.weight, weights(layer.name + ".weight", taps * spec.in_channels * spec.out_channels));
  E2LF_ASSIGN_OR_RETURN(spec.bias, weights(layer.name + ".bias", spec.out_channels));
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

void PlanBuilder::add(const model::Layer& layer, std::unique_ptr<Kernel> kernel, const std::string& stage) {
  std::vector<size_t> inputs;
  for (const std::string& input : layer.inputs) inputs.push_back(tensor(input));
  const std::string& name = stage.empty() ? layer.name : stage;
  set_result(layer, add_part(name, std::move(kernel), std::move(inputs), spec(layer.name)));
  if (!layer.residual.empty()) plan_.stages.back().residual = tensor(layer.residual);
}

size_t PlanBuilder::add_part(const std::string& stage, std::unique_ptr<Kernel> kernel, std::vector<size_t> inputs,
                             const TensorSpec& spec) {
  plan_.stages.push_back({stage, std::move(kernel), std::move(inputs), std::nullopt});
  plan_.tensors.push_back(spec);
  return plan_.tensors.size() - 1;
}

Plan PlanBuilder::finish(std::optional<ConvSpec> head) {
  for (RecurrentState& state : plan_.states) {
    if (state.kept == kOutput) state.kept = plan_.tensors.size() - 1;
  }
  plan_.head = std::move(head);
  measure_halo();
  return std::move(plan_);
}

void PlanBuilder::measure_halo() {
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
  size_t multiple = 1;
  for (const TensorSpec& tensor : plan_.tensors) multiple = std::lcm(multiple, tensor.scale);
  plan_.alignment = multiple * kTileSize;
  plan_.halo = round_up(halo.back(), plan_.alignment);
}

}  // namespace e2lf::engine
