// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/diagnose/finding.h"
#include "e2lf/recordings/event.h"

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

/// The rising or the falling edges of a trigger input.
struct TriggerEdges {
  uint64_t count = 0;
  int64_t last_us = 0;
  std::vector<int64_t> times_us;  ///< of the first kMostTimes

  static constexpr size_t kMostTimes = 4096;
  /// Returns the mean time between edges, or 0 if there are fewer than two.
  [[nodiscard]] double period_us() const {
    return count < 2 ? 0.0 : static_cast<double>(last_us - times_us.front()) / static_cast<double>(count - 1);
  }
};
struct TriggerInput {
  TriggerEdges rising, falling;
};
using TriggerInputs = std::map<uint16_t, TriggerInput>;

void add(std::span<const recordings::Trigger> triggers, TriggerInputs& inputs);

/// Returns the number of rising and falling edges of each trigger input and the mean time between them.
[[nodiscard]] Json to_json(const TriggerInputs& inputs);

/// Describes in one line the triggers found and those that the schedule expects: inputs, edges, counts and the usual
/// interval.
[[nodiscard]] std::string triggers_text(const TriggerInputs& inputs, const cycles::Schedule& schedule);

/// Returns the most likely reason why the triggers do not form whole cycles of the schedule, or nothing if they match
/// it. `last_us` is the last time of the recording.
[[nodiscard]] std::optional<Finding> check_triggers(const TriggerInputs& inputs, const cycles::CycleOptions& options,
                                                    int64_t last_us);

/// A trigger whose time contradicts the schedule and the previous cycles, while its neighbours agree with them.
struct LateTrigger {
  uint64_t cycle = 0;   ///< its number in the recording
  size_t pattern = 0;   ///< the pattern that the trigger begins
  int64_t late_us = 0;  ///< negative if it is too early
};

/// Finds single triggers that are out of step: the interval before such a trigger is longer by as much as the interval
/// after it is shorter. A shift that repeats in every cycle is a property of the display and is learned.
class LateTriggerFinder {
 public:
  /// Adds the next complete cycle, and returns its triggers that are out of step.
  [[nodiscard]] std::vector<LateTrigger> add(const cycles::Cycle& cycle, const cycles::Schedule& schedule);

 private:
  [[nodiscard]] double expected_us(size_t pattern, const cycles::Schedule& schedule) const;

  std::map<size_t, std::deque<double>> intervals_us_;  ///< the latest ones that followed each pattern
  std::optional<cycles::PatternStart> before_;         ///< the last start of the previous cycle
  uint64_t next_cycle_ = 0;
};

}  // namespace e2lf::diagnose
