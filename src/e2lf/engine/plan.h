// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/engine/conv.h"
#include "e2lf/model/network.h"

namespace e2lf::engine {

/// A tensor in the engine. `scale` is the number of input pixels per pixel along an axis.
struct TensorSpec {
  size_t channels = 0;
  size_t scale = 1;
  ElementType type = ElementType::kFloat32;
};

/// One step of evaluation: a kernel and the tensors that it reads. Stage i makes tensor i + 1; tensor 0 is the input.
struct Stage {
  std::string name;  ///< name of the layer or of the fused layers; "<layer>.<part>" for a part of a layer
  std::shared_ptr<const Kernel> kernel;  ///< shared by plans
  std::vector<size_t> inputs;
  std::optional<size_t> residual;

  /// Returns the inputs, followed by the residual.
  [[nodiscard]] std::vector<size_t> reads() const;
};

/// A state carried from frame to frame: tensor `recalled` is tensor `kept` of the previous frame, initially zero.
struct RecurrentState {
  size_t recalled = 0, kept = 0;
};

/// A network that is ready to run. The last tensor is the output.
struct Plan {
  std::vector<TensorSpec> tensors;
  std::vector<Stage> stages;
  std::vector<RecurrentState> states;  ///< if empty, frames are independent
  bool needs_whole_rows = false;       ///< images must not be cut into panels
  size_t alignment = 1;  ///< cuts of an image must be multiples of this many pixels so that the same tiles are computed
  size_t halo = 0;       ///< pixels beside a cut on which results depend, a multiple of `alignment`
  std::optional<ConvSpec> head;  ///< the last stage, if it is a single convolution without a residual
};

/// Chooses kernels and packs weights. Layers on which the output does not depend are omitted. Fails as infer_shapes
/// does, and with kNotFound or kShape for missing or wrong weights. `compute` = kBfloat16 requires
/// bfloat16_supported(); for `int16_products` see ConvSpec.
[[nodiscard]] Result<Plan> make_plan(const model::Network& network, const model::Weights& weights, ElementType compute,
                                     bool int16_products = false);

/// Returns a plan with the same kernels that computes only some channels of the output, or nothing if its last kernel
/// cannot. It must have no states.
[[nodiscard]] std::optional<Plan> with_outputs(const Plan& plan, std::span<const size_t> channels);

}  // namespace e2lf::engine
