// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>

#include "e2lf/cycles/schedule.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// Returns the index of the first of events [begin, end) that is not before until_us, or `end`. The search uses
/// doubling steps, because runs may consist of one event or of many.
[[nodiscard]] inline size_t end_of_run(const recordings::EventColumns& events, size_t begin, size_t end,
                                       int64_t until_us) {
  size_t step = 1, low = begin;
  while (low + step < end && events.t[low + step] < until_us) {
    low += step;
    step *= 2;
  }
  const auto first = events.t.begin() + static_cast<ptrdiff_t>(low);
  const auto last = events.t.begin() + static_cast<ptrdiff_t>(std::min(low + step, end));
  return static_cast<size_t>(std::lower_bound(first, last, until_us) - events.t.begin());
}

/// The numbers of ON and OFF events over time, in bins of 100 us. Memory grows with the time that is kept.
class EventHistogram {
 public:
  static constexpr int64_t kBinUs = 100;
  struct Counts {
    uint32_t on = 0, off = 0;
  };

  /// Returns the start of the bin that contains a time.
  [[nodiscard]] static int64_t bin_of(int64_t t_us);

  /// Counts events [begin, end).
  void add(const recordings::EventColumns& events, size_t begin, size_t end);
  /// Returns the counts of the bins with begin_us <= start < end_us.
  [[nodiscard]] Counts count(int64_t begin_us, int64_t end_us) const;
  void forget_before(int64_t t_us);

 private:
  std::map<int64_t, Counts> bins_;  ///< keys are the starts of the bins
};

/// The change of the event rate at a time: the events of the following window compared with those of the preceding one,
/// separately for ON and OFF.
struct EventRise {
  double on = 0, off = 0;   ///< additional events compared with before
  double all = 0;           ///< in both windows
  double significance = 0;  ///< significance of the rise, in standard deviations at a constant rate

  [[nodiscard]] double total() const { return on + off; }
};
[[nodiscard]] EventRise event_rise(const EventHistogram& histogram, int64_t t_us, int64_t window_us);

/// Returns the confidence, 0..1, that a pattern change begins where a rise was measured: its share of the events,
/// reduced by what chance may have caused and by what has the wrong sign.
[[nodiscard]] float change_confidence(const EventRise& rise, BurstSign sign);

/// Returns the confidence, 0..1, that the rates of ON and OFF events change abruptly at a time, upwards or downwards.
/// This is how slow pixels show a change: while they still follow one change, the next one ends its events. The change
/// of the rates must have the right sign, must be larger than anywhere else within `window_us`, and must vanish at that
/// distance.
[[nodiscard]] float abrupt_change_confidence(const EventHistogram& histogram, int64_t t_us, int64_t window_us,
                                             BurstSign sign);

}  // namespace e2lf::cycles
