// SPDX-License-Identifier: MIT
#include "e2lf/recordings/trigger_feed.h"

#include <utility>

#include "e2lf/recordings/event_gate.h"
#include "e2lf/recordings/restart.h"

namespace e2lf::recordings {

Result<void> TriggerFeed::refill(DecodeSummary& summary) {
  while (!ended_ && block_.size() - next_ <= kRestartWitnesses) {
    block_.erase(block_.begin(), block_.begin() + static_cast<ptrdiff_t>(next_));
    next_ = 0;
    E2LF_ASSIGN_OR_RETURN(const bool more, source_->next(block_, summary));
    ended_ = !more;
  }
  return {};
}

/// Triggers are few, so that a decreasing one at the end may be the only trigger of the later part.
bool TriggerFeed::starts_again() const {
  const auto time_at = [&](size_t i) { return block_[i].t; };
  return block_[next_].t < last_us_ && !is_last_part_ && is_restart(next_, block_.size(), last_us_, time_at, 0);
}

void TriggerFeed::begin_part() {
  if (std::exchange(is_at_restart_, false)) last_us_ = -kTimeLimitUs;
}

bool TriggerFeed::is_believable(DecodeSummary& summary) const {
  const bool backwards = block_[next_].t < last_us_;
  const auto time_at = [&](size_t i) { return block_[i].t; };
  if (!backwards && is_time(block_[next_].t) && !is_ahead_of_successors(next_, block_.size(), last_us_, time_at))
    return true;
  summary.add_dropped(backwards ? Violation::kTimeBackwards : Violation::kTimeJump, 0);
  return false;
}

Result<bool> TriggerFeed::take(int64_t until_us, size_t max_triggers, std::vector<Trigger>& triggers,
                               DecodeSummary& summary) {
  for (size_t taken = 0;; ++next_) {
    E2LF_RETURN_IF_ERROR(refill(summary));
    if (next_ == block_.size()) return false;
    is_at_restart_ = starts_again();
    if (is_at_restart_) return true;
    if (!is_believable(summary)) continue;
    const Trigger& trigger = block_[next_];
    if (taken == max_triggers || trigger.t > until_us) return true;
    triggers.push_back(trigger);
    last_us_ = trigger.t;
    ++taken;
  }
}

Result<void> TriggerFeed::rewind() {
  block_.clear();
  next_ = 0;
  last_us_ = -kTimeLimitUs;
  is_at_restart_ = is_last_part_ = false;
  ended_ = source_ == nullptr;
  return source_ == nullptr ? Result<void>{} : source_->rewind();
}

}  // namespace e2lf::recordings
