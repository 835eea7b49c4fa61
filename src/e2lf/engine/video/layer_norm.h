// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// model::Op::kLayerNorm, of one type; `weight` and `bias` of each channel.
[[nodiscard]] std::unique_ptr<Kernel> make_layer_norm(const std::vector<float>& weight, const std::vector<float>& bias,
                                                      ElementType type);

}  // namespace e2lf::engine
