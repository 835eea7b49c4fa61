// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "e2lf/cycles/schedule.h"

namespace e2lf::cycles {

/// A sign that the pattern on the aperture changed: a trigger, or the start of a burst of events.
struct Mark {
  int64_t t_us = 0;
  std::optional<float> on_share;  ///< of the burst's events, 0..1; nothing for a trigger
  float confidence = 1.0F;        ///< that it is a change at all, 0..1
};

/// When a pattern of the schedule began.
struct PatternStart {
  enum class Kind {
    kSeen,
    kMissing,  ///< no mark came; t_us is where it should have been
    kDoubled,  ///< a mark came that the schedule does not have; `pattern` is the one being shown
    kLost,     ///< the marks no longer follow the schedule; the pattern is unknown from here on
  };
  int64_t t_us = 0;
  size_t pattern = 0;
  Kind kind = Kind::kSeen;
  float confidence = 1.0F;
};

struct TrackerOptions {
  /// The pattern of the first mark; nothing = found from the intervals and signs of the first cycle.
  std::optional<size_t> first_pattern;
  /// The pattern of the first mark where intervals and signs leave several, this one among them; nothing = unknown
  /// then.
  std::optional<size_t> likely_first_pattern = {};
  /// How far an interval may be from the expected one, as a share of it.
  double tolerance = 0.2;
};

/// Tells which pattern each mark begins. Intervals between marks must follow the schedule; the expected ones are kept
/// up to date, so a steady overhead or clock error does no harm. A mark that is missing is noticed because the interval
/// is that of two or more patterns, a mark too many because the interval is too short.
class PatternTracker {
 public:
  PatternTracker(const Schedule& schedule, const TrackerOptions& options);

  /// Takes the next mark, in order of time, and appends what is known now.
  void add(const Mark& mark, std::vector<PatternStart>& starts);

  /// The recording has ended: appends what the marks that are left tell.
  void finish(std::vector<PatternStart>& starts);

  /// Whether likely_first_pattern had to decide.
  [[nodiscard]] bool has_assumed_first() const { return has_assumed_first_; }

  /// Up to when the starts are known, given that all marks before t_us were added: earlier while the first cycle is
  /// still being looked for.
  [[nodiscard]] int64_t known_until(int64_t t_us) const;

  /// Whether the pattern of the last mark is known; the intervals of the next one tell then, and no sign is needed.
  [[nodiscard]] bool is_locked() const { return pattern_.has_value() || (is_first_ && options_.first_pattern); }

  /// The expected time from the start of a pattern to the next start.
  [[nodiscard]] int64_t interval_us(size_t pattern) const { return static_cast<int64_t>(interval_us_[pattern]); }

  /// Marks whose pattern could not be told.
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
  std::optional<size_t> pattern_;  ///< of the last mark; nothing while it is looked for
  int64_t last_us_ = 0;
  std::deque<Mark> found_;  ///< marks whose patterns are being looked for
  bool is_first_ = true;
  bool has_locked_ = false;  ///< at any time
  bool has_assumed_first_ = false;
  size_t misfits_ = 0;  ///< marks in a row that the schedule does not have
  uint64_t unassigned_ = 0;
};

}  // namespace e2lf::cycles
