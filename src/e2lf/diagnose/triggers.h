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

/// The edges of one trigger input.
struct TriggerInput {
  uint64_t rising = 0, falling = 0;
  std::vector<int64_t> rising_us, falling_us;  ///< the times of the first kMostTimes

  static constexpr size_t kMostTimes = 4096;
};
using TriggerInputs = std::map<uint16_t, TriggerInput>;

void add(std::span<const recordings::Trigger> triggers, TriggerInputs& inputs);

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
