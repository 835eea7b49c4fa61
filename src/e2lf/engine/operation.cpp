// SPDX-License-Identifier: MIT
#include "e2lf/engine/operation.h"

#include <algorithm>
#include <mutex>
#include <numeric>

#include "e2lf/base/text.h"

namespace e2lf::engine {
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
