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
  void forget_before(int64_t t_us) { bins_.erase(bins_.begin(), bins_.lower_bound(t_us)); }

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

/// The time at which a pattern of the schedule began.
struct PatternStart {
  enum class Kind {
    kSeen,
    kMissing,  ///< there was no mark; t_us is the expected time
    kDoubled,  ///< there was a mark that the schedule does not contain; `pattern` is the one being shown
    kLost,     ///< the marks no longer follow the schedule; the pattern is unknown from here on
  };
  int64_t t_us = 0;
  size_t pattern = 0;
  Kind kind = Kind::kSeen;
  float confidence = 1.0F;
};

struct TrackerOptions {
  /// The pattern of the first mark; if absent, it is found from the intervals and signs of the first cycle.
  std::optional<size_t> first_pattern;
  /// The pattern of the first mark if intervals and signs leave several possibilities including this one; if absent,
  /// the pattern is then unknown. Triggers are often set up to begin with the sequence; bursts ignore it.
  std::optional<size_t> likely_first_pattern = 0;
  /// The permitted deviation of an interval, relative to the expected one.
  double tolerance = 0.2;
};

/// A mark that follows another within this part of the shortest interval is a bounce of the same edge.
inline constexpr double kBounceShare = 0.05;

/// Determines which pattern each mark begins. The intervals between marks must follow the schedule. The expected
/// intervals are updated, so that a constant overhead or clock error does no harm. A missing mark is noticed because
/// the interval is that of two or more patterns, and an additional one because the interval is too short. One that
/// follows another at once is a bounce of the same edge and is ignored.
class PatternTracker {
 public:
  PatternTracker(const Schedule& schedule, const TrackerOptions& options);

  /// Adds the next mark, in order of time, and appends the starts that are now known.
  void add(const Mark& mark, std::vector<PatternStart>& starts);

  /// Ends the recording and appends the starts that the remaining marks determine.
  void finish(std::vector<PatternStart>& starts);

  /// Returns true if likely_first_pattern decided.
  [[nodiscard]] bool has_assumed_first() const { return has_assumed_first_; }

  /// Returns the time up to which the starts are known, given that all marks before t_us were added. It is earlier
  /// while the pattern is being searched.
  [[nodiscard]] int64_t known_until(int64_t t_us) const;

  /// Returns true if the pattern of the last mark is known. The interval to the next mark is then sufficient, without a
  /// sign.
  [[nodiscard]] bool is_locked() const { return pattern_.has_value() || (is_first_ && options_.first_pattern); }

  /// Returns the expected time from the start of a pattern to the next start.
  [[nodiscard]] int64_t interval_us(size_t pattern) const { return static_cast<int64_t>(interval_us_[pattern]); }

  /// Returns the number of marks whose pattern could not be determined.
  [[nodiscard]] uint64_t unassigned_marks() const { return unassigned_ + found_.size(); }

 private:
  void search(std::vector<PatternStart>& starts);
  [[nodiscard]] std::optional<size_t> find_phase();
  [[nodiscard]] bool lock(std::vector<PatternStart>& starts);
  [[nodiscard]] std::optional<float> phase_score(size_t phase) const;
  [[nodiscard]] bool follow(const Mark& mark, std::vector<PatternStart>& starts);
  void learn(size_t pattern, double interval_us);
  [[nodiscard]] size_t after(size_t pattern, size_t steps = 1) const { return (pattern + steps) % interval_us_.size(); }

  Schedule schedule_;
  TrackerOptions options_;
  std::vector<double> interval_us_;
  std::optional<size_t> pattern_;  ///< pattern of the last mark; absent while it is being searched
  int64_t last_us_ = 0;
  std::optional<int64_t> last_mark_us_;  ///< of any mark that is no bounce
  std::deque<Mark> found_;               ///< marks whose patterns are being searched
  bool is_first_ = true;
  bool has_locked_ = false;  ///< true once a pattern has been found
  bool has_assumed_first_ = false;
  size_t misfits_ = 0;  ///< consecutive marks that the schedule does not contain
  uint64_t unassigned_ = 0;
};

}  // namespace e2lf::cycles
