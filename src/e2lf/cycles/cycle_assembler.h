// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/cycles/event_histogram.h"

namespace e2lf::cycles {

/// Puts cycles together from pattern starts and events, both in order of time.
class CycleAssembler {
 public:
  CycleAssembler(const CycleOptions& options, size_t width, size_t height);

  /// Takes the next start. Starts may be given before the events of their time, and out of order while they lie in the
  /// future.
  void add_start(const PatternStart& start);

  /// Takes the events that come next, and leaves others in their place.
  void add_events(recordings::EventColumns& events);

  /// Works through everything before until_us: all starts up to then must be known. The tracker knows the expected
  /// intervals; null = those of the schedule.
  void process(int64_t until_us, const PatternTracker* tracker);

  /// The recording ended; last_us is the last time it had.
  void finish(int64_t last_us);

  /// The oldest complete cycle.
  [[nodiscard]] std::optional<Cycle> take();

  [[nodiscard]] const CycleReport& report() const { return report_; }

 private:
  struct Open {
    Cycle cycle;
    std::optional<DroppedCycle> fault;
    std::vector<PatternStart> starts;  ///< of its patterns
  };

  void begin_cycle(int64_t t_us);
  void end_cycle();
  void apply(const PatternStart& start, const PatternTracker* tracker);
  [[nodiscard]] float confidence_of(const std::vector<PatternStart>& starts) const;
  [[nodiscard]] bool is_last_of_cycle(size_t pattern) const;
  void close_overdue(int64_t until_us);
  void close_pattern(int64_t end_us);
  void set_fault(CycleFault fault, int64_t t_us);
  void consume_events(int64_t until_us);
  void accumulate(size_t begin, size_t end);
  void give_up_waiting();

  CycleOptions options_;
  size_t width_, height_;
  size_t first_pattern_;  ///< of a cycle
  std::optional<PixelFilter> filter_;
  int64_t window_us_;         ///< before and after a claimed start, in which the events must confirm it
  EventHistogram histogram_;  ///< of the open cycle

  std::deque<PatternStart> starts_;
  recordings::EventColumns events_;  ///< waiting, from next_ on
  size_t next_ = 0;

  std::optional<Open> open_;
  std::optional<size_t> pattern_;  ///< on the aperture now; nothing when not known
  int64_t pattern_begin_us_ = 0;
  int64_t expected_end_us_ = 0;
  int64_t deadline_us_ = 0;  ///< a start that has not come by then is missing
  int64_t quiet_us_ = 0;     ///< in this cycle
  uint64_t next_number_ = 0;
  std::deque<Cycle> complete_;
  CycleReport report_;
};

}  // namespace e2lf::cycles
