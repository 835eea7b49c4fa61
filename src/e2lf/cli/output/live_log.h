// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/cycles/cycle_reader.h"

namespace e2lf::cli {

/// Logs the progress of live input, whose end is not known: one line for each completed cycle, and totals at the end.
/// Independent of whether stderr is a terminal; silent with --quiet.
class LiveLog {
 public:
  /// Logs a completed cycle; `latency_s` is the time since the end of its last pattern.
  void add(uint64_t cycle, uint64_t events, double latency_s);
  /// Logs the totals at the end of the input. Does nothing if add() was never called.
  void finish(const cycles::CycleReport& report) const;

 private:
  uint64_t cycles_ = 0, events_ = 0;
  double sum_s_ = 0, most_s_ = 0;
};

}  // namespace e2lf::cli
