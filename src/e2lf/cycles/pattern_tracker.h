// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "e2lf/cycles/marks.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

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
