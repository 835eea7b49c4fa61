// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// Makes the kernel of model::Op::kSigmoid, whose input and output have the same type.
[[nodiscard]] std::unique_ptr<Kernel> make_sigmoid(size_t channels, ElementType type);

}  // namespace e2lf::engine
