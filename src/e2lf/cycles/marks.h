// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "e2lf/cycles/schedule.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// An indication that the pattern on the aperture changed: a trigger, or the start of a burst of events.
struct Mark {
  int64_t t_us = 0;
  std::optional<float> on_share;  ///< share of ON events in the burst, 0..1; absent for a trigger
  float confidence = 1.0F;        ///< confidence that the mark is a pattern change, 0..1
  double rise = 0;                ///< number of events by which the burst exceeds what preceded it, with `on_share`
};

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

/// Returns the confidence, 0..1, that a pattern change begins at a time: the share of the events by which the rate of
/// the following window exceeds that of the preceding one, reduced by what chance may have caused and by what has the
/// wrong sign.
[[nodiscard]] float change_confidence(const EventHistogram& histogram, int64_t t_us, int64_t window_us, BurstSign sign);

/// Returns the confidence, 0..1, that the rates of ON and OFF events change abruptly at a time, upwards or downwards.
/// This is how slow pixels show a change: while they still follow one change, the next one ends its events. The change
/// of the rates must have the right sign, must be larger than anywhere else within `window_us`, and must vanish at that
/// distance.
[[nodiscard]] float abrupt_change_confidence(const EventHistogram& histogram, int64_t t_us, int64_t window_us,
                                             BurstSign sign);

/// Assigns to triggers the sign of the burst of events after them, as bursts have it themselves: a change to black
/// makes OFF events, and one to white ON events. The pattern can thus be found again after a loss although the
/// intervals between triggers repeat within a cycle (both half cycles of the paper's sequence have the same intervals).
class TriggerSigns {
 public:
  /// Adds the next events, and the triggers of their time.
  void add(const recordings::EventColumns& events, const std::vector<Mark>& marks);

  /// Returns the oldest trigger: with its sign once the events after it are known (or at the end), or at once and
  /// without sign if `needs_sign` is false. Returns nothing if there is none yet.
  [[nodiscard]] std::optional<Mark> take(bool needs_sign, bool is_end);

  /// Returns the time before which all triggers up to `last_us` have been returned.
  [[nodiscard]] int64_t known_until(int64_t last_us) const {
    return marks_.empty() ? last_us : std::min(last_us, marks_.front().t_us);
  }

 private:
  void add_sign(Mark& mark) const;

  std::deque<Mark> marks_;
  EventHistogram histogram_;
  int64_t first_event_us_ = INT64_MAX, last_event_us_ = INT64_MIN;
};

/// Detects the starts of bursts in the event rate, separately for ON and OFF so that a burst is visible in the tail of
/// one of the other sign. A burst starts where the count of the next window exceeds that of the previous one most. It
/// works on events as they arrive, with a delay.
class BurstDetector {
 public:
  static constexpr int64_t kBinUs = EventHistogram::kBinUs;  ///< resolution of the starts

  /// Processes the next events and appends the bursts that are now certain.
  void add(const recordings::EventColumns& events, std::vector<Mark>& marks);

  /// Appends the bursts at the end of the recording.
  void finish(std::vector<Mark>& marks);

  /// Returns the time before which all bursts have been found.
  [[nodiscard]] int64_t known_until_us() const;

 private:
  using Bin = EventHistogram::Counts;
  struct Rise {
    double count = 0;         ///< additional events compared with before
    double significance = 0;  ///< in standard deviations
    double on_share = 0.5;
  };

  void begin_in_silence();
  void close_bins(int64_t until_bin, std::vector<Mark>& marks);
  void judge(std::vector<Mark>& marks);
  [[nodiscard]] Rise rise_at(size_t bin) const;
  [[nodiscard]] size_t foot_of(size_t bin) const;
  [[nodiscard]] int64_t time_of(size_t bin) const { return (first_bin_ + static_cast<int64_t>(bin)) * kBinUs; }

  std::deque<Bin> bins_;    ///< complete bins, from first_bin_ on
  std::deque<Rise> rises_;  ///< of the bins with a whole window on both sides; the first one belongs to the bin after
                            ///< the first window
  int64_t first_bin_ = 0;
  bool has_begun_ = false;
  Bin open_;
  int64_t open_bin_ = 0;
  double typical_rise_ = 0;
  std::optional<int64_t> last_mark_us_;
};

}  // namespace e2lf::cycles
