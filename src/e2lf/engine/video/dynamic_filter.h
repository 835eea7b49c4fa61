// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// model::Op::kDynamicFilter: inputs x [channels] and f [filter_values], of one type, as the output.
[[nodiscard]] std::unique_ptr<Kernel> make_dynamic_filter(size_t channels, size_t filter_values, size_t kernel,
                                                          ElementType type);

}  // namespace e2lf::engine
