// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// Applies E2LF_MAX_ISA (scalar, sse4, avx2, avx512, amx) from the environment to every kernel of this process.
/// Without the variable nothing changes. Call once, before the first kernel runs.
/// Fails with kInvalidValue on another word.
[[nodiscard]] Result<void> apply_isa_cap();

/// The same from a word; "" lifts the cap. Another word changes nothing.
[[nodiscard]] Result<void> set_max_isa(const std::string& isa);

/// What kernels run as now: "scalar", "sse4", "avx2", "avx512", or "amx", which is avx512 with tiles of bfloat16.
[[nodiscard]] std::string current_isa();

/// The words this CPU can run under the present cap, slowest first; tests of kernels loop over them.
[[nodiscard]] std::vector<std::string> available_isas();

}  // namespace e2lf
