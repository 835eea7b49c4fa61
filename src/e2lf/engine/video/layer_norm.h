// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// Makes the kernel of model::Op::kLayerNorm, whose input and output have the same type. `weight` and `bias` have one
/// value per channel.
[[nodiscard]] std::unique_ptr<Kernel> make_layer_norm(const std::vector<float>& weight, const std::vector<float>& bias,
                                                      ElementType type);

}  // namespace e2lf::engine
