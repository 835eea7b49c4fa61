// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace e2lf::recordings {

/// The treatment of a clock that starts again within a recording, because a camera was restarted or recordings were
/// concatenated.
enum class RestartPolicy {
  kContinue,  ///< shift the later part so that its times follow those of the earlier part
  kSplit,     ///< read the parts separately; see RecordingReader::next_part()
  kRefuse,    ///< fail with an Error that states the position
};

/// Minimum decrease of a restart; times that decrease by less are late events or damage. Decreases of up to 11 us have
/// been observed in recordings; the high bits of EVT3 times have steps of 4,096 us, of which two are required.
inline constexpr int64_t kMinRestartUs = 8'000;

/// Number of times after a decrease that are inspected, and the minimum number that must exist.
inline constexpr size_t kRestartWitnesses = 64;
inline constexpr size_t kMinRestartWitnesses = 8;

/// Returns true if the clock starts again at time i of `count`, whose predecessor is last_us: the time decreases by
/// kMinRestartUs or more, and three quarters of the next kRestartWitnesses times continue from it, that is, they do not
/// decrease and are before last_us. Returns false if fewer than `fewest` times follow; the caller ensures that
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
  // A run of equal times, for example of zeroed bytes, is not a running clock.
  const bool runs = latest_us > first_us || asked == 0;
  return asked >= fewest && 4 * in_favour >= 3 * asked && runs;
}

}  // namespace e2lf::recordings
