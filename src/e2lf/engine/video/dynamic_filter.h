// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// Makes the kernel of model::Op::kDynamicFilter. Its inputs are x [channels] and f [filter_values], of the same type
/// as the output.
[[nodiscard]] std::unique_ptr<Kernel> make_dynamic_filter(size_t channels, size_t filter_values, size_t kernel,
                                                          ElementType type);

}  // namespace e2lf::engine
