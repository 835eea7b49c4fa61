// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {

/// Returns the patterns between which the transitions of a display's whole cycle lie, [2N + 1, view_y, view_x]: a1 to
/// aN, the inverses of a1 to aN, and a1 again.
[[nodiscard]] Codes whole_cycle(const Codes& codes);

/// Returns a1 to aN of what whole_cycle() made of two patterns or more; nothing where the codes are other ones.
[[nodiscard]] std::optional<Codes> codes_of_whole_cycle(const Codes& codes);

}  // namespace e2lf::capture
