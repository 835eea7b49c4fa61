// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>

#include "e2lf/base/planes.h"

namespace e2lf::capture {

/// The event images of one cycle: int16 [transition, y, x], row-major. Each value is the sum of the signed events (+1
/// ON, -1 OFF) of a pixel during one transition between patterns (Eq. 2). N patterns have N - 1 transitions.
using EventImages = Planes<int16_t>;

/// Returns the count, limited to the range of int16.
[[nodiscard]] inline int16_t saturated(int count) {
  return static_cast<int16_t>(std::clamp<int>(count, INT16_MIN, INT16_MAX));
}

/// Returns whether no pixel has an event.
[[nodiscard]] inline bool is_without_events(const EventImages& images) {
  return std::ranges::all_of(images.values, [](int16_t count) { return count == 0; });
}

}  // namespace e2lf::capture
