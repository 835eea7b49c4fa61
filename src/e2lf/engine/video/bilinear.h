// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// Makes the kernel of model::Op::kUpsampleBilinear by `stride`, whose input and output have the same type. `relu` is
/// as in model::Layer.
[[nodiscard]] std::unique_ptr<Kernel> make_bilinear(size_t channels, size_t stride, bool relu, ElementType type);

}  // namespace e2lf::engine
