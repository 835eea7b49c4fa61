// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

#include "e2lf/cycles/schedule.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// ON and OFF events over time, in bins of 100 us. Memory grows with the time that is not forgotten.
class EventHistogram {
 public:
  static constexpr int64_t kBinUs = 100;
  struct Counts {
    uint32_t on = 0, off = 0;
  };

  /// The start of the bin that a time lies in.
  [[nodiscard]] static int64_t bin_of(int64_t t_us);

  /// Counts events [begin, end).
  void add(const recordings::EventColumns& events, size_t begin, size_t end);
  /// The bins with begin_us <= start < end_us.
  [[nodiscard]] Counts count(int64_t begin_us, int64_t end_us) const;
  void forget_before(int64_t t_us);

 private:
  std::map<int64_t, Counts> bins_;  ///< by the time they begin at
};

/// What changes at a time: the events of the window from it on against those of the window before, ON and OFF apart.
struct EventRise {
  double on = 0, off = 0;   ///< events more than before
  double all = 0;           ///< in both windows
  double significance = 0;  ///< of the rise, in standard deviations of chance

  [[nodiscard]] double total() const { return on + off; }
};
[[nodiscard]] EventRise event_rise(const EventHistogram& histogram, int64_t t_us, int64_t window_us);

/// How surely a pattern change begins where a rise was measured, 0..1: its share of the events, less what chance may
/// have made and what has the wrong sign.
[[nodiscard]] float change_confidence(const EventRise& rise, BurstSign sign);

/// How surely the rates of ON and OFF events change abruptly right at a time, 0..1, be it to more events or to fewer.
/// That is what slow pixels show: while they still follow one change, the next one ends its events. The change of the
/// rates must have the sign, be greater there than anywhere within `window_us`, and be gone that far away.
[[nodiscard]] float abrupt_change_confidence(const EventHistogram& histogram, int64_t t_us, int64_t window_us,
                                             BurstSign sign);

}  // namespace e2lf::cycles
