// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "e2lf/capture/measurement/hot_pixels.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// Finds hot pixels by their counts in the last cycles, and gives them the counts of their neighbours.
class PixelFilter {
 public:
  /// Adds the images of a cycle, and replaces the counts of the pixels that are known to be hot.
  void apply(capture::EventImages& images);

  [[nodiscard]] size_t num_hot() const { return hot_.size(); }

 private:
  capture::CountSums sums_;
  uint64_t added_ = 0;  ///< cycles
  std::vector<size_t> hot_;
};

/// Assembles cycles from pattern starts and events, both in order of time.
class CycleAssembler {
 public:
  CycleAssembler(const CycleOptions& options, size_t width, size_t height);

  /// Adds the next start. Starts may be added before the events of their time, and out of order while they lie in the
  /// future.
  void add_start(const PatternStart& start);

  /// Takes the next events; the content of `events` is unspecified afterwards.
  void add_events(recordings::EventColumns& events);

  /// Processes everything before until_us; all starts up to then must be known. The tracker provides the expected
  /// intervals; if it is null, those of the schedule are used.
  void process(int64_t until_us, const PatternTracker* tracker);

  /// Ends the recording. last_us is its last time.
  void finish(int64_t last_us);

  /// Reads every `cycles`-th cycle completely; see CycleReader::read_whole_every().
  void make_whole_every(uint64_t cycles) { whole_every_ = cycles; }

  /// Returns the time span, from the current pattern on, whose events are needed by no image and, unless the cycle is
  /// read completely, by no check; nothing if there is none.
  [[nodiscard]] std::optional<TimeSlice> unused_time(const PatternTracker& tracker) const;

  /// Returns the oldest complete cycle.
  [[nodiscard]] std::optional<Cycle> take();

  [[nodiscard]] const CycleReport& report() const { return report_; }

 private:
  struct Open {
    Cycle cycle;
    std::optional<DroppedCycle> fault;
    bool is_whole = true;  ///< whether the events of all its patterns are read
  };

  void begin_cycle(int64_t t_us);
  void end_cycle();
  void set_confidence();
  void apply(const PatternStart& start, const PatternTracker* tracker);
  [[nodiscard]] float confidence_of(const std::vector<PatternStart>& starts) const;
  [[nodiscard]] bool is_last_of_cycle(size_t pattern) const;
  void close_overdue(int64_t until_us);
  void close_pattern(int64_t end_us);
  void set_fault(CycleFault fault);
  void consume_events(int64_t until_us);
  void accumulate(size_t begin, size_t end);
  void give_up_waiting();

  CycleOptions options_;
  size_t width_, height_;
  size_t first_pattern_;  ///< index of the first pattern of a cycle
  std::optional<PixelFilter> filter_;
  int64_t window_us_;         ///< length of time before and after a claimed start in which events must confirm it
  EventHistogram histogram_;  ///< events of the open cycle

  std::deque<PatternStart> starts_;
  recordings::EventColumns events_;  ///< waiting events are those from next_ on
  size_t next_ = 0;

  std::optional<Open> open_;
  std::optional<size_t> pattern_;  ///< the pattern on the aperture; absent if unknown
  int64_t pattern_begin_us_ = 0;
  int64_t expected_end_us_ = 0;
  int64_t deadline_us_ = 0;  ///< a start that has not occurred by then is missing
  uint64_t whole_every_ = 1;
  float whole_confidence_ = 1.0F;  ///< confidence of the last whole cycle
  uint64_t next_number_ = 0;
  std::deque<Cycle> complete_;
  CycleReport report_;
};

}  // namespace e2lf::cycles
