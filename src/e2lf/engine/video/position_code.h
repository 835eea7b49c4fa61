// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// model::Op::kPositionCode, of one type.
[[nodiscard]] std::unique_ptr<Kernel> make_position_code(size_t channels, ElementType type);

}  // namespace e2lf::engine
