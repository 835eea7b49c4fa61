// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "e2lf/recordings/event_blocks.h"

namespace e2lf::recordings {

struct TimeSortOptions {
  size_t memory_events = size_t{1} << 22;  ///< so many are sorted in memory, 13 bytes each; more go through a file
  size_t pipe_events = size_t{1} << 16;    ///< so many wait for earlier ones where the source cannot be read twice
};

/// Blocks in order of time, whatever the order in `blocks`; events of one time keep theirs. What is out of order is
/// counted (DecodeSummary::out_of_order), nothing is dropped. Where the clock starts again, it goes on
/// (continued_clock.h), and parts are not mixed.
/// A source that can be sought is read once to see whether it is in order and, when it is not and holds more than
/// memory_events, sorted through a temporary file (SortedRuns). One that cannot be sought is sorted as it comes, and
/// next() fails with kUnsupported at an event that comes more than pipe_events too late. `name` is the location.
[[nodiscard]] std::unique_ptr<EventBlocks> make_time_sorted(std::unique_ptr<EventBlocks> blocks, bool is_seekable,
                                                            std::string name, const TimeSortOptions& options = {});

}  // namespace e2lf::recordings
