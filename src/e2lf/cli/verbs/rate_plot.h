// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/cycles/pattern_tracker.h"
#include "e2lf/recordings/event_rate.h"
#include "e2lf/report/chart.h"

namespace e2lf::cli {

/// What was found in a recording, for its picture.
struct FoundCycle {
  uint64_t number = 0;
  float confidence = 1.0F;
  std::vector<cycles::TimeSlice> slices;  ///< of its event images
};
struct FoundCycles {
  std::vector<cycles::Mark> marks;  ///< triggers or bursts
  std::vector<FoundCycle> cycles;
};

/// The event rate over time: ON above the axis, OFF below, in ms and M events/s; a tick at the foot for each mark, and
/// each cycle's number, confidence and slices shaded. Of a long recording the first kMaxDrawn marks and cycles are
/// drawn.
[[nodiscard]] report::LineChart rate_chart(const recordings::EventRate& rate, const FoundCycles& found = {});
inline constexpr size_t kMaxDrawn = 2000;

}  // namespace e2lf::cli
