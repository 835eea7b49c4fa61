// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>

#include "e2lf/base/median.h"
#include "e2lf/base/result.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// Number of neighbouring times that are inspected for one, so that a single damaged time does not mislead the search.
inline constexpr size_t kTimesPerProbe = 5;

/// Number of evenly spaced positions that show whether times rise from one to the next.
inline constexpr uint64_t kRiseProbes = 64;

/// Finds a position in [0, count) after which no event at or after t_us is missed, near the first of them, by bisecting
/// positions with time_at(position), which returns a Result<int64_t>, or INT64_MAX for a position without a time. If
/// the clock starts again between some of kRiseProbes positions, only the first part could be bisected, and the result
/// is 0. Meant for positions that are looked up one by one in a file.
template <typename TimeAt>
[[nodiscard]] Result<uint64_t> find_place_before(uint64_t count, int64_t t_us, const TimeAt& time_at) {
  int64_t last_us = INT64_MIN;
  for (uint64_t i = 0; i < kRiseProbes && count > kRiseProbes; ++i) {
    E2LF_ASSIGN_OR_RETURN(const int64_t probe_us, time_at(i * (count - 1) / (kRiseProbes - 1)));
    if (probe_us < last_us && last_us - probe_us > kDisorderUs) return 0;
    if (probe_us != INT64_MAX) last_us = probe_us;
  }
  uint64_t low = 0, high = count;  // time_at(low) < t_us or low = 0; time_at(high) >= t_us or high = count
  while (high - low > 1) {
    const uint64_t middle = low + (high - low) / 2;
    E2LF_ASSIGN_OR_RETURN(const int64_t middle_us, time_at(middle));
    (middle_us < t_us ? low : high) = middle;
  }
  // A median also inspects positions after its own.
  return low - std::min<uint64_t>(low, kTimesPerProbe);
}

}  // namespace e2lf::recordings
