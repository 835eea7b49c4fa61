// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// model::Op::kAttention: inputs q, k and v [channels], of one type, as the output. Keys come in blocks, with a running
/// softmax: a thread needs memory for a few queries and keys, whatever the size of the image.
[[nodiscard]] std::unique_ptr<Kernel> make_attention(size_t channels, size_t heads, ElementType type);

}  // namespace e2lf::engine
