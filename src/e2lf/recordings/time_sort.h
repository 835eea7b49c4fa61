// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {

struct TimeSortOptions {
  size_t memory_events = size_t{1} << 22;  ///< maximum number sorted in memory (13 bytes each); more use a file
  size_t pipe_events = size_t{1} << 16;    ///< number of events that are buffered if the source is not seekable
};

/// Sorts blocks by time; events with equal times keep their order. Events that are out of order are counted
/// (DecodeSummary::out_of_order), and none is dropped. Times continue across restarts of the clock (continued_clock.h),
/// and parts are not mixed.
/// A seekable source is first read once to check its order. If it is not in order and contains more than memory_events,
/// it is sorted with a temporary file (SortedRuns). Other sources are sorted while they are read, and next() fails with
/// kUnsupported if an event is more than pipe_events too late. `name` is the location in errors.
[[nodiscard]] BlocksPtr make_time_sorted(BlocksPtr blocks, bool is_seekable, std::string name,
                                         const TimeSortOptions& options = {});

}  // namespace e2lf::recordings
