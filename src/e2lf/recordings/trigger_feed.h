// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// A source of triggers that are stored separately from the events (in a second file or data set), in order of time.
class TriggerSource {
 public:
  virtual ~TriggerSource() = default;

  /// Appends the next triggers to `block` and counts those that cannot be read. Returns false at the end.
  [[nodiscard]] virtual Result<bool> next(std::vector<Trigger>& block, DecodeSummary& summary) = 0;

  /// Returns to the first trigger.
  [[nodiscard]] virtual Result<void> rewind() = 0;
};

/// Delivers the triggers of a source together with the events of the same time, with one block in memory. Triggers
/// whose time decreases without a restart of the clock, is later than most of the following ones, or exceeds
/// kTimeLimitUs, are dropped and counted in the summary of the reader.
class TriggerFeed {
 public:
  TriggerFeed() = default;
  explicit TriggerFeed(std::unique_ptr<TriggerSource> source)
      : source_(std::move(source)), ended_(source_ == nullptr) {}

  /// Appends the triggers with t <= until_us, at most `max_triggers`. Returns false if no trigger remains at any time.
  [[nodiscard]] Result<bool> take(int64_t until_us, size_t max_triggers, std::vector<Trigger>& triggers,
                                  DecodeSummary& summary);

  /// Returns true if all triggers of this part were returned and those of a later part follow, whose clock starts
  /// again.
  [[nodiscard]] bool is_at_restart() const { return is_at_restart_; }

  /// Continues with the triggers of the later part, if there are any.
  void begin_part();

  /// Declares that no later part follows, so that decreasing times are damage from here on.
  void end_parts() { is_last_part_ = true; }

  /// Starts again from the first trigger.
  [[nodiscard]] Result<void> rewind();

 private:
  [[nodiscard]] Result<void> refill(DecodeSummary& summary);
  [[nodiscard]] bool starts_again() const;
  [[nodiscard]] bool is_believable(DecodeSummary& summary) const;

  std::unique_ptr<TriggerSource> source_;
  std::vector<Trigger> block_;
  size_t next_ = 0;
  bool ended_ = true;
  bool is_at_restart_ = false, is_last_part_ = false;
  int64_t last_us_ = -kTimeLimitUs;
};

}  // namespace e2lf::recordings
