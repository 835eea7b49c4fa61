// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace e2lf::cycles {

/// Measures how long after a trigger the events of its pattern set in, over the beginning of a recording. Pixels answer
/// within a millisecond, so that events that set in before their trigger tell of a trigger that comes late.
class OnsetCheck {
 public:
  /// Counts events, whose times rise from call to call. What comes more than kWatchedUs after the first is not counted.
  void add_events(std::span<const int64_t> times_us);

  /// Takes the time at which a pattern is said to begin.
  void add_start(int64_t t_us);

  /// Returns the time of the largest relative rise of the event rate near a start, summed over all starts; negative
  /// where events set in before their start. Looks half the shortest interval to either side. Returns nothing where
  /// there are fewer than kMinStarts starts, too few events, or no clear rise.
  [[nodiscard]] std::optional<int64_t> onset_us() const;

  static constexpr int64_t kWatchedUs = 2'000'000;
  static constexpr size_t kMinStarts = 6;

 private:
  /// Returns the events around the starts, summed over these, in bins of 100 us; the middle is the start.
  [[nodiscard]] std::vector<uint64_t> profile(int64_t reach_us) const;

  std::optional<int64_t> first_us_;
  std::vector<uint32_t> counts_;  ///< of events, for each 100 us since the first
  std::vector<int64_t> starts_us_;
};

}  // namespace e2lf::cycles
