// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace e2lf::recordings {

/// What to do where the clock of a recording starts again: a camera was restarted, or recordings were joined.
enum class RestartPolicy {
  kContinue,  ///< move the later part, so that its time goes on behind the earlier one
  kSplit,     ///< keep the parts apart: RecordingReader::next_part()
  kRefuse,    ///< an Error that names the place
};

/// Time that falls by less is a straggler or damage, never a restart. The recordings at hand step back by at most 11
/// us; the coarse time of EVT3 comes in steps of 4,096 us, of which two are needed.
inline constexpr int64_t kMinRestartUs = 8'000;

/// How many of the times behind a fall are asked whether they go on from it, and how many there must be.
inline constexpr size_t kRestartWitnesses = 64;
inline constexpr size_t kMinRestartWitnesses = 8;

/// Returns whether the clock starts again with time i of `count`, which is earlier than the one in front of it,
/// last_us: it falls by kMinRestartUs, and three quarters of the kRestartWitnesses times behind it go on from it, as
/// they rise and stay below last_us. Fewer times than `fewest` do not suffice; the caller makes sure that
/// kRestartWitnesses follow unless the recording ends.
template <typename TimeAt>
[[nodiscard]] bool is_restart(size_t i, size_t count, int64_t last_us, const TimeAt& time_at,
                              size_t fewest = kMinRestartWitnesses) {
  const int64_t first_us = time_at(i);
  if (first_us > last_us - kMinRestartUs) return false;
  const size_t asked = std::min(count - i - 1, kRestartWitnesses);
  size_t in_favour = 0;
  int64_t latest_us = first_us;
  for (size_t k = i + 1; k <= i + asked; ++k) {
    const int64_t t_us = time_at(k);
    if (t_us < latest_us || t_us >= last_us) continue;
    ++in_favour;
    latest_us = t_us;
  }
  // A stretch of one time, as of zeroed bytes, is no clock that runs.
  const bool runs = latest_us > first_us || asked == 0;
  return asked >= fewest && 4 * in_favour >= 3 * asked && runs;
}

}  // namespace e2lf::recordings
