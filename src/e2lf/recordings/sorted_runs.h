// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"

namespace e2lf::recordings {

/// Puts events in order of time; events of one time keep their order.
void sort_by_time(EventColumns& events);

/// Events in order of time in a temporary file without a name, for more of them than memory should hold: sorted runs
/// are added, then merged. 16 bytes of disk for each event, in TMPDIR or /tmp; they go when the object goes, or the
/// process.
class SortedRuns {
 public:
  SortedRuns() = default;
  SortedRuns(const SortedRuns&) = delete;
  SortedRuns& operator=(const SortedRuns&) = delete;
  ~SortedRuns();

  /// Sorts the events and adds them as the next run. Fails with kIo.
  [[nodiscard]] Result<void> add(EventColumns& events);

  /// Starts to merge from the first event; runs added later are not seen.
  void rewind();

  /// Replaces `events` by the next ones, at most `max_events`; of one time, those of earlier runs come first. False
  /// when there are no more. Fails with kIo.
  [[nodiscard]] Result<bool> next(EventColumns& events, size_t max_events);

 private:
  /// What is left of a run, and the part of it in memory.
  struct Run {
    uint64_t next = 0, end = 0;  ///< events of the file
    std::vector<Event> buffer;
    size_t place = 0;
  };
  /// Where the next event of a run stands in the order of all.
  struct Head {
    int64_t t_us = 0;
    size_t run = 0;
    bool operator>(const Head& other) const { return t_us != other.t_us ? t_us > other.t_us : run > other.run; }
  };

  [[nodiscard]] Result<void> open_file();
  [[nodiscard]] Result<bool> refill(Run& run);
  [[nodiscard]] Result<void> begin_merge();

  int descriptor_ = -1;
  std::vector<uint64_t> begins_ = {0};  ///< of the runs, in events, and the end
  std::vector<Run> runs_;               ///< while merging
  std::vector<Head> heads_;             ///< a heap, the earliest in front
  bool is_merging_ = false;
};

}  // namespace e2lf::recordings
