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
  int64_t window_us = 1000;      ///< events this long behind a trigger are compared with those before it
  double min_significance = 10;  ///< rise of the count in standard deviations of chance; less gives no sign
};

/// Gives triggers the sign of the burst of events behind them, which bursts have of themselves: a change to black makes
/// OFF events, one to white ON events. With that the pattern is found again after a loss although the intervals between
/// triggers repeat within a cycle (the two half cycles of the paper's sequence are alike).
class MarkSigner {
 public:
  explicit MarkSigner(const SignOptions& options) : options_(options) {}

  /// Takes the next events, and the triggers of their time.
  void add(const recordings::EventColumns& events, const std::vector<Mark>& marks);

  /// The oldest trigger: with its sign once the events behind it are known (or `is_end`), and at once, without, when
  /// `needs_sign` is false. Nothing when there is none yet.
  [[nodiscard]] std::optional<Mark> take(bool needs_sign, bool is_end);

  /// Triggers before this time have been given out, of all until `last_us`.
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
