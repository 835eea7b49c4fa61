// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/cycles/pattern_tracker.h"
#include "e2lf/recordings/event_rate.h"
#include "e2lf/report/chart.h"

namespace e2lf::cli {

/// The marks and cycles that were found in a recording, for its chart.
struct FoundCycle {
  uint64_t number = 0;
  float confidence = 1.0F;
  std::vector<cycles::TimeSlice> slices;  ///< time slices of its event images
};
struct FoundCycles {
  std::vector<cycles::Mark> marks;  ///< triggers or bursts
  std::vector<FoundCycle> cycles;
};

/// Returns a chart of the event rate over time in ms and million events/s, ON above the axis and OFF below, with a tick
/// for each mark, and with each cycle's number, confidence and shaded slices. Of a long recording, the first kMaxDrawn
/// marks and cycles are drawn.
[[nodiscard]] report::LineChart rate_chart(const recordings::EventRate& rate, const FoundCycles& found = {});
inline constexpr size_t kMaxDrawn = 2000;

}  // namespace e2lf::cli
