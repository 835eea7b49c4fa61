// SPDX-License-Identifier: MIT
// Implements the reader of blocks of events of event_blocks.h.
#include <algorithm>
#include <deque>
#include <utility>

#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/event_gate.h"

namespace e2lf::recordings {
namespace {

class BlockReader final : public RecordingReader {
 public:
  BlockReader(BlocksPtr blocks, RecordingInfo info, const std::string& name, const OpenOptions& options,
              TriggerFeed triggers)
      : RecordingReader(options),
        blocks_(std::move(blocks)),
        triggers_apart_(std::move(triggers)),
        gate_(info.width, info.height, blocks_->event_bytes()) {
    info_ = std::move(info);
    name_ = name;
  }

 protected:
  Result<bool> read_next(EventBatch& batch, size_t max_events) override {
    if (next_ == events_.size()) E2LF_RETURN_IF_ERROR(read_block());
    for (; is_part_over(); begin_later_part()) {
      const size_t before = batch.triggers.size();
      E2LF_RETURN_IF_ERROR(take_triggers(batch, INT64_MAX, max_events));
      if (batch.triggers.size() > before) return true;
    }
    const size_t end = std::min(part_end(), next_ + max_events);
    const bool more = end < events_.size() || !has_ended_ || part_end_us() != INT64_MAX;
    const int64_t until_us = !more ? INT64_MAX : end == next_ ? INT64_MIN : events_.t[end - 1];
    const size_t begin = batch.events.size();
    if (next_ == 0 && begin == 0 && end == events_.size()) {
      std::swap(batch.events, events_);
      events_.clear();
    } else {
      batch.events.append(events_, next_, end);
      next_ = end;
    }
    if (const int64_t moved_us = shift_us(); moved_us != 0) {
      for (size_t i = begin; i < batch.events.size(); ++i) batch.events.t[i] -= moved_us;
    }
    if (batch.events.size() > begin) last_us_ = std::max(last_us_, batch.events.t.back());
    if (until_us == INT64_MIN) return more;
    if (!more) triggers_apart_.end_parts();
    E2LF_ASSIGN_OR_RETURN(const bool more_triggers, take_triggers(batch, until_us, max_events));
    return more || more_triggers;
  }

  Result<void> seek_before(int64_t t_us) override {
    E2LF_RETURN_IF_ERROR(blocks_->seek_before(t_us));
    // Triggers after the last event of a part delay the times of the later parts, so that seeking starts at the front.
    if (!blocks_->restarts().empty()) E2LF_RETURN_IF_ERROR(blocks_->seek_before(INT64_MIN));
    events_.clear();
    next_ = part_ = 0;
    triggers_.clear();
    last_trigger_us_ = last_us_ = -kTimeLimitUs;
    has_ended_ = false;
    gate_.reset();
    return triggers_apart_.rewind();
  }

 private:
  Result<void> read_block() {
    events_.clear();
    next_ = 0;
    block_.clear();
    if (!has_ended_) {
      E2LF_ASSIGN_OR_RETURN(const bool has_block, blocks_->next(block_, summary_));
      has_ended_ = !has_block;
    }
    gate_.release(events_);
    events_.append(block_.events);
    gate_.filter(events_, 0, has_ended_, blocks_->block_byte(), summary_);
    for (const Trigger& trigger : block_.triggers) {
      if (is_time(trigger.t))
        triggers_.push_back(trigger);
      else
        summary_.add(Violation::kTimeBackwards, 0);
    }
    return {};
  }

  /// Returns the shift of the times of the current part.
  [[nodiscard]] int64_t shift_us() const { return part_ == 0 ? 0 : blocks_->restarts()[part_ - 1].shift_us; }

  /// Returns the first time of the next part on the clock of the blocks, or INT64_MAX if none is known.
  [[nodiscard]] int64_t part_end_us() const {
    const std::span<const Restart> restarts = blocks_->restarts();
    return part_ == restarts.size() ? INT64_MAX : restarts[part_].after_us + restarts[part_].shift_us;
  }

  /// Returns the end of the current part in events_.
  [[nodiscard]] size_t part_end() const {
    if (events_.empty() || events_.t.back() < part_end_us()) return events_.size();
    const auto from = events_.t.begin() + static_cast<ptrdiff_t>(next_);
    return static_cast<size_t>(std::lower_bound(from, events_.t.end(), part_end_us()) - events_.t.begin());
  }

  /// Returns true if all events of the current part were returned and a later part follows.
  [[nodiscard]] bool is_part_over() const {
    if (part_end_us() == INT64_MAX) return false;
    return next_ == events_.size() ? has_ended_ : part_end() == next_;
  }

  void begin_later_part() {
    const Restart restart = blocks_->restarts()[part_];
    ++part_;
    triggers_apart_.begin_part();
    // If no event of a part was plausible, the next part follows the previous one directly.
    if (last_us_ > -kTimeLimitUs) begin_part(restart.byte, last_us_);
    last_trigger_us_ = last_us_ = -kTimeLimitUs;
  }

  /// Appends the triggers of this part up to a time on the clock of the blocks. Returns true if more remain.
  Result<bool> take_triggers(EventBatch& batch, int64_t until_us, size_t max_triggers) {
    const size_t begin = batch.triggers.size();
    bool more = take_block_triggers(batch, std::min(until_us, part_end_us() - 1), max_triggers);
    if (const size_t room = max_triggers - std::min(max_triggers, batch.triggers.size()); room > 0) {
      const int64_t own_us = until_us == INT64_MAX ? until_us : until_us - shift_us();
      E2LF_ASSIGN_OR_RETURN(const bool more_apart, triggers_apart_.take(own_us, room, batch.triggers, summary_));
      more |= more_apart;
    }
    if (batch.triggers.size() > begin) last_us_ = std::max(last_us_, batch.triggers.back().t);
    return more;
  }

  bool take_block_triggers(EventBatch& batch, int64_t until_us, size_t max_triggers) {
    for (size_t taken = 0; !triggers_.empty() && triggers_.front().t <= until_us; triggers_.pop_front()) {
      if (taken == max_triggers) return true;
      Trigger trigger = triggers_.front();
      trigger.t -= shift_us();
      if (trigger.t < last_trigger_us_) {
        summary_.add(Violation::kTimeBackwards, 0);
        continue;
      }
      last_trigger_us_ = trigger.t;
      batch.triggers.push_back(trigger);
      ++taken;
    }
    return false;
  }

  BlocksPtr blocks_;
  TriggerFeed triggers_apart_;
  EventGate gate_;
  EventBatch block_;
  EventColumns events_;  ///< plausible events, not yet returned from next_ on, with the continuous times of the blocks
  size_t next_ = 0;
  std::deque<Trigger> triggers_;
  size_t part_ = 0;                          ///< number of restarts of the blocks before next_
  int64_t last_trigger_us_ = -kTimeLimitUs;  ///< time of the last trigger that was returned in this part
  int64_t last_us_ = -kTimeLimitUs;          ///< latest time that was returned in this part
  bool has_ended_ = false;                   ///< whether all blocks were read
};

}  // namespace

ReaderPtr make_block_reader(BlocksPtr blocks, RecordingInfo info, const std::string& name, const OpenOptions& options,
                            TriggerFeed triggers) {
  return std::make_unique<BlockReader>(std::move(blocks), std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::recordings
