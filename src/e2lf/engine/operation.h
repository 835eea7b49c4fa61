// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/engine/plan.h"
#include "e2lf/model/operation.h"

namespace e2lf::engine {

/// Assembles a plan stage by stage. Tensors are identified by their numbers, and the results of layers also by the
/// names of the layers.
class PlanBuilder {
 public:
  /// `specs` are the tensors of all layers and of "input" by name; `output` is the last layer.
  PlanBuilder(const model::Weights& weights, std::map<std::string, TensorSpec> specs, const std::string& output,
              ElementType compute, bool int16_products);

  /// Returns the type in which the network computes, which is that of tensors unless their spec says otherwise.
  [[nodiscard]] ElementType compute() const { return compute_; }

  /// Returns the tensor of the result of a layer, and its number, which it has once it was added.
  [[nodiscard]] const TensorSpec& spec(const std::string& name) const { return specs_.at(name); }
  [[nodiscard]] size_t tensor(const std::string& name) const { return tensor_.at(name); }

  /// Returns weights. Fails with kShape if the operation of their layer does not state them, with this size.
  [[nodiscard]] Result<std::vector<float>> weights(const std::string& name, size_t size) const;

  /// Returns the convolution of a layer, with the weights "<name>.weight" and "<name>.bias", from `in_channels`
  /// channels to the type of compute().
  [[nodiscard]] Result<ConvSpec> conv(const model::Layer& layer, size_t in_channels) const;

  /// Adds the stage that computes a layer from its inputs. `stage` names it in logs if it is more than the layer.
  void add(const model::Layer& layer, std::unique_ptr<Kernel> kernel, const std::string& stage = "");

  /// Adds a stage whose result has no layer name, for layers of several stages. Returns the number of the result.
  size_t add_part(const std::string& stage, std::unique_ptr<Kernel> kernel, std::vector<size_t> inputs,
                  const TensorSpec& spec);

  /// Declares which tensor is the result of a layer of several stages.
  void set_result(const model::Layer& layer, size_t tensor) { tensor_[layer.name] = tensor; }

  /// Makes tensor `recalled` equal to `kept`, or to the output of the network, of the previous frame.
  void remember(size_t recalled, size_t kept) { plan_.states.push_back({recalled, kept}); }
  void remember_output(size_t recalled) { remember(recalled, kOutput); }

  /// Returns the type of the output of the network.
  [[nodiscard]] ElementType output_type() const { return output_type_; }

  /// Completes the plan. `head` is the last stage if it is a single convolution.
  [[nodiscard]] Plan finish(std::optional<ConvSpec> head);

 private:
  static constexpr size_t kOutput = ~size_t{0};  ///< the last tensor, whose number is not yet known

  void measure_halo();

  const model::Weights& weights_;
  ElementType compute_, output_type_;
  bool int16_products_;
  Plan plan_;
  std::map<std::string, TensorSpec> specs_;
  std::map<std::string, size_t> tensor_;
};

/// An operation that this engine runs beside those of model::Op: what it means for a network, and how it is computed.
/// docs/library.md adds one.
struct Operation {
  model::Operation model;

  /// Adds the stages of a layer: usually one kernel, by PlanBuilder::add(). Fails as PlanBuilder does.
  Result<void> (*plan)(PlanBuilder& build, const model::Layer& layer) = nullptr;

  bool has_wide_sums = false;  ///< its output can be float32 if its inputs are bfloat16
};

/// Makes an operation known to this process, to model files and to the engine, before the first network with it is
/// used. A name that is taken breaks the contract.
void add_operation(const Operation& operation);

/// Returns the added operation of that name, or null.
[[nodiscard]] const Operation* find_operation(const std::string& name);

}  // namespace e2lf::engine
