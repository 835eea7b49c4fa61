// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "e2lf/cycles/event_histogram.h"
#include "e2lf/cycles/pattern_tracker.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

struct SignOptions {
  int64_t window_us = 1000;      ///< in which events after a trigger are compared with those before it
  double min_significance = 10;  ///< of the rise of the count, in standard deviations at a constant rate
};

/// Assigns to triggers the sign of the burst of events after them, as bursts have it themselves: a change to black
/// makes OFF events, and one to white ON events. The pattern can thus be found again after a loss although the
/// intervals between triggers repeat within a cycle (both half cycles of the paper's sequence have the same intervals).
class TriggerSigns {
 public:
  explicit TriggerSigns(const SignOptions& options) : options_(options) {}

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
  [[nodiscard]] std::optional<float> on_share_at(int64_t t_us) const;
  void forget();

  SignOptions options_;
  std::deque<Mark> marks_;
  EventHistogram histogram_;
  int64_t first_event_us_ = INT64_MAX, last_event_us_ = INT64_MIN;
};

}  // namespace e2lf::cycles
