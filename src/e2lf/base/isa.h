// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// Caps the instruction set of every kernel of this process at the one named by the environment variable E2LF_MAX_ISA
/// (scalar, sse4, avx2, avx512 or amx). Without the variable, nothing changes. It must be called once, before the first
/// kernel runs. Fails with kInvalidValue for any other name.
[[nodiscard]] Result<void> apply_isa_cap();

/// Caps the instruction set at the one named by `isa`; "" removes the cap. An unknown name changes nothing and fails
/// with kInvalidValue.
[[nodiscard]] Result<void> set_max_isa(const std::string& isa);

/// Returns the instruction set that kernels use now: "scalar", "sse4", "avx2", "avx512", or "amx", which is avx512 with
/// bfloat16 tiles.
[[nodiscard]] std::string current_isa();

/// Returns the names of the instruction sets that this CPU can run under the present cap, slowest first. Tests of
/// kernels iterate over them.
[[nodiscard]] std::vector<std::string> available_isas();

}  // namespace e2lf
