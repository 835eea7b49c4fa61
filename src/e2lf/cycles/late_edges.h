// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "e2lf/cycles/pattern_tracker.h"

namespace e2lf::cycles {

/// A trigger whose time contradicts the schedule and the previous cycles, while its neighbours agree with them.
struct LateEdge {
  uint64_t cycle = 0;   ///< its number in the recording
  size_t pattern = 0;   ///< the pattern that the trigger begins
  int64_t late_us = 0;  ///< negative if it is too early
};

/// Finds single triggers that are out of step: the interval before such a trigger is longer by as much as the interval
/// after it is shorter. A shift that repeats in every cycle is a property of the display and is learned.
class LateEdgeFinder {
 public:
  explicit LateEdgeFinder(const Schedule& schedule);

  /// Adds the next pattern start, and returns the finding about the previous one.
  [[nodiscard]] std::optional<LateEdge> add(const PatternStart& start);

 private:
  [[nodiscard]] double expected_us(size_t pattern) const;
  void learn(size_t pattern, double interval_us);

  Schedule schedule_;
  std::vector<std::deque<double>> intervals_us_;  ///< the latest ones that followed each pattern
  std::optional<PatternStart> before_, last_;
};

}  // namespace e2lf::cycles
