// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/cycles/cycle_reader.h"

namespace e2lf::cli {

/// Tells of live input while it comes, since its end is not known: on stderr a line for each cycle that is done, and
/// totals at the end. Terminal or not; nothing with --quiet.
class LiveLog {
 public:
  /// A cycle of live input is done; `latency_s` after the end of its last pattern.
  void add(uint64_t cycle, uint64_t events, double latency_s);
  /// The input has ended. Says nothing where add() was never called.
  void finish(const cycles::CycleReport& report) const;

 private:
  uint64_t cycles_ = 0, events_ = 0;
  double sum_s_ = 0, most_s_ = 0;
};

}  // namespace e2lf::cli
