// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// How many neighbouring times are looked at for one: one that is damaged then leads nowhere.
inline constexpr size_t kTimesPerProbe = 5;

/// The middle one of some times.
[[nodiscard]] inline int64_t median_time(std::vector<int64_t> times_us) {
  const auto middle = times_us.begin() + static_cast<ptrdiff_t>(times_us.size() / 2);
  std::nth_element(times_us.begin(), middle, times_us.end());
  return *middle;
}

/// A place in [0, count) from which on no event of t_us or later is missed, near the first of them: bisects sorted
/// places by time_at(place), a Result<int64_t>. For places that are looked up one by one in a file.
template <typename TimeAt>
[[nodiscard]] Result<uint64_t> find_place_before(uint64_t count, int64_t t_us, const TimeAt& time_at) {
  uint64_t low = 0, high = count;  // time_at(low) < t_us or low = 0; time_at(high) >= t_us or high = count
  while (high - low > 1) {
    const uint64_t middle = low + (high - low) / 2;
    E2LF_ASSIGN_OR_RETURN(const int64_t middle_us, time_at(middle));
    (middle_us < t_us ? low : high) = middle;
  }
  // A median looks at places behind its own.
  return low - std::min<uint64_t>(low, kTimesPerProbe);
}

}  // namespace e2lf::recordings
