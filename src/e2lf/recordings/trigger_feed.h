// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// Triggers that lie apart from the events (a second file or data set), in order of time.
class TriggerSource {
 public:
  virtual ~TriggerSource() = default;

  /// Appends the next triggers to `block` and counts what cannot be read; false at the end.
  [[nodiscard]] virtual Result<bool> next(std::vector<Trigger>& block, DecodeSummary& summary) = 0;

  /// Goes back to the first trigger.
  [[nodiscard]] virtual Result<void> rewind() = 0;
};

/// Hands the triggers of a source out beside the events they belong to, one block in memory at a time. A trigger whose
/// time steps back other than because the clock starts again, is ahead of most that follow, or beyond kTimeLimitUs, is
/// dropped and counted in the reader's summary.
class TriggerFeed {
 public:
  TriggerFeed() = default;
  explicit TriggerFeed(std::unique_ptr<TriggerSource> source)
      : source_(std::move(source)), ended_(source_ == nullptr) {}

  /// Appends the triggers with t <= until_us, at most `max_triggers`. False when there are no more at all.
  [[nodiscard]] Result<bool> take(int64_t until_us, size_t max_triggers, std::vector<Trigger>& triggers,
                                  DecodeSummary& summary);

  /// Whether the triggers of this part have ended and those of a later one wait, whose clock starts again.
  [[nodiscard]] bool is_at_restart() const { return is_at_restart_; }

  /// Goes on with those of the later part, where some wait.
  void begin_part();

  /// There is no later part: times that fall are damage from here on.
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
