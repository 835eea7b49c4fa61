// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace e2lf::diagnose {

/// Measures the delay between the triggers and the first events of their patterns, over the beginning of a recording.
/// Pixels respond within a millisecond, so that a negative delay indicates that the triggers are late.
class EventDelay {
 public:
  /// Counts events, whose times must not decrease from call to call, up to kWatchedUs after the first one.
  void add_events(std::span<const int64_t> times_us);

  /// Adds the time at which a pattern begins according to its trigger.
  void add_start(int64_t t_us);

  /// Returns the time of the largest relative rise of the event rate, relative to the starts and summed over all of
  /// them; it is negative if the events begin before their start. Half the shortest interval on either side is
  /// searched. Returns nothing if there are fewer than kMinStarts starts, too few events, or no clear rise.
  [[nodiscard]] std::optional<int64_t> delay_us() const;

  static constexpr int64_t kWatchedUs = 2'000'000;
  static constexpr size_t kMinStarts = 6;

 private:
  /// Returns the number of events around the starts, summed over all starts, in bins of 100 us; the start is in the
  /// middle.
  [[nodiscard]] std::vector<uint64_t> profile(int64_t reach_us) const;

  std::optional<int64_t> first_us_;
  std::vector<uint32_t> counts_;  ///< number of events in each 100 us since the first one
  std::vector<int64_t> starts_us_;
};

}  // namespace e2lf::diagnose
