// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {

/// Returns the patterns that a display shows in a whole cycle, [2N + 1, view_y, view_x]: a_1 to a_N, the inverses of
/// a_1 to a_N, and a_1 again. Their 2N transitions are those of the cycle.
[[nodiscard]] Codes whole_cycle(const Codes& codes);

/// Returns the patterns a_1 to a_N from which whole_cycle() made `codes`, for N of at least 2; nothing if `codes` do
/// not have this form.
[[nodiscard]] std::optional<Codes> codes_of_whole_cycle(const Codes& codes);

}  // namespace e2lf::capture
