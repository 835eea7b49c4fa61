// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// Returns the index of the first of events [begin, end) that is not before until_us, or `end`. The search uses
/// doubling steps, because runs may consist of one event or of many.
[[nodiscard]] inline size_t end_of_run(const recordings::EventColumns& events, size_t begin, size_t end,
                                       int64_t until_us) {
  size_t step = 1, low = begin;
  while (low + step < end && events.t[low + step] < until_us) {
    low += step;
    step *= 2;
  }
  const auto first = events.t.begin() + static_cast<ptrdiff_t>(low);
  const auto last = events.t.begin() + static_cast<ptrdiff_t>(std::min(low + step, end));
  return static_cast<size_t>(std::lower_bound(first, last, until_us) - events.t.begin());
}

}  // namespace e2lf::cycles
