// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// Makes the kernel of model::Op::kAttention. Its inputs are q, k and v [channels], of the same type as the output. The
/// keys are processed in blocks with a running softmax, so that a thread needs memory for only a few queries and keys
/// at any image size.
[[nodiscard]] std::unique_ptr<Kernel> make_attention(size_t channels, size_t heads, ElementType type);

}  // namespace e2lf::engine
