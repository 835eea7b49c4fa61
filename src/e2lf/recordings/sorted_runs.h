// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"

namespace e2lf::recordings {

/// Sorts events by time; the order of events with equal times is preserved.
void sort_by_time(EventColumns& events);

/// Sorts more events than memory should hold, with a temporary file that has no name: sorted runs are added and then
/// merged. Needs 16 bytes of disk space per event in TMPDIR or /tmp, which are released with the object or the process.
class SortedRuns {
 public:
  SortedRuns() = default;
  SortedRuns(const SortedRuns&) = delete;
  SortedRuns& operator=(const SortedRuns&) = delete;
  ~SortedRuns();

  /// Sorts the events and adds them as the next run. Fails with kIo.
  [[nodiscard]] Result<void> add(EventColumns& events);

  /// Starts merging from the first event; runs that are added later are not included.
  void rewind();

  /// Replaces `events` by the next ones, at most `max_events`. Of events with equal times, those of earlier runs come
  /// first. Returns false when there are no more. Fails with kIo.
  [[nodiscard]] Result<bool> next(EventColumns& events, size_t max_events);

 private:
  /// The remainder of a run, and the part of it in memory.
  struct Run {
    uint64_t next = 0, end = 0;  ///< indices of events in the file
    std::vector<Event> buffer;
    size_t place = 0;
  };
  /// The position of the next event of a run in the overall order.
  struct Head {
    int64_t t_us = 0;
    size_t run = 0;
    bool operator>(const Head& other) const { return t_us != other.t_us ? t_us > other.t_us : run > other.run; }
  };

  [[nodiscard]] Result<void> open_file();
  [[nodiscard]] Result<bool> refill(Run& run);
  [[nodiscard]] Result<void> begin_merge();

  int descriptor_ = -1;
  std::vector<uint64_t> begins_ = {0};  ///< begin of each run in events, and the end of the last
  std::vector<Run> runs_;               ///< while merging
  std::vector<Head> heads_;             ///< a heap, the earliest in front
  bool is_merging_ = false;
};

}  // namespace e2lf::recordings
