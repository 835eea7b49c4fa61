// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace e2lf::cycles {

/// Measures how long after a trigger the event rate changes, over the beginning of a recording. A change of pattern
/// starts the events of fast pixels, and ends those with which slow pixels still follow the previous change. If the
/// rate changes before the trigger, the trigger comes late.
class OnsetCheck {
 public:
  /// Counts events, whose times rise from call to call. What comes more than kWatchedUs after the first is not counted.
  void add_events(std::span<const int64_t> times_us);

  /// Takes the time at which a pattern is said to begin.
  void add_start(int64_t t_us);

  /// Returns the time relative to the starts at which the event rate changes most abruptly, upwards or downwards, over
  /// all starts together; negative if that is before them. It is searched within half the shortest interval, at most 5
  /// ms, to either side. Returns nothing if there are fewer than kMinStarts starts, or if no time stands out.
  [[nodiscard]] std::optional<int64_t> onset_us() const;

  static constexpr int64_t kWatchedUs = 2'000'000;
  static constexpr size_t kMinStarts = 6;

 private:
  /// Returns the sum, over the starts, of the squared change of the rate in units of its chance deviation.
  [[nodiscard]] double score_at(int64_t offset_us) const;

  std::optional<int64_t> first_us_;
  std::vector<uint32_t> counts_;  ///< of events, for each 100 us since the first
  std::vector<int64_t> starts_us_;
};

}  // namespace e2lf::cycles
