// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/engine/kernel.h"
#include "e2lf/model/model.h"

namespace e2lf::engine {

/// A tensor that flows through the engine; `scale` = input pixels per pixel.
struct TensorSpec {
  size_t channels = 0;
  size_t scale = 1;
  ElementType type = ElementType::kFloat32;
};

/// One step of evaluation: a kernel with the tensors it reads. Stage i makes tensor i + 1; tensor 0 is the input.
struct Stage {
  std::string name;  ///< of the layer, or of those made into one; "<layer>.<part>" of a part of one
  std::unique_ptr<Kernel> kernel;
  std::vector<size_t> inputs;
  std::optional<size_t> residual;

  /// Inputs, then the residual.
  [[nodiscard]] std::vector<size_t> reads() const;
};

/// What goes from frame to frame: tensor `recalled` is what tensor `kept` was at the end of the frame before, or zero.
struct State {
  size_t recalled = 0, kept = 0;
};

/// A network made ready to run; the last tensor is the output.
struct Plan {
  std::vector<TensorSpec> tensors;
  std::vector<Stage> stages;
  std::vector<State> states;      ///< none: every frame is for itself
  bool needs_whole_rows = false;  ///< images are not cut
  size_t alignment = 1;  ///< pixels that cut edges of an image must be multiples of for the same tiles to be computed
  size_t halo = 0;       ///< pixels beside a cut that results depend on, a multiple of `alignment`
};

/// Chooses kernels and packs weights; layers that the output does not depend on are left out. Fails as infer_shapes
/// does, and with kNotFound / kShape for missing or wrong weights. `compute` = bfloat16 needs bfloat16_supported().
[[nodiscard]] Result<Plan> make_plan(const model::Network& network, const model::Weights& weights, ElementType compute);

}  // namespace e2lf::engine
