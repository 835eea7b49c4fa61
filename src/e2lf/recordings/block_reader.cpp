// SPDX-License-Identifier: MIT
#include <algorithm>
#include <deque>
#include <utility>

#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/event_gate.h"

namespace e2lf::recordings {
namespace {

class BlockReader final : public RecordingReader {
 public:
  BlockReader(std::unique_ptr<EventBlocks> blocks, RecordingInfo info, const std::string& name,
              const OpenOptions& options, TriggerFeed triggers)
      : RecordingReader(options),
        blocks_(std::move(blocks)),
        triggers_apart_(std::move(triggers)),
        gate_(info.width, info.height, blocks_->event_bytes()) {
    info_ = std::move(info);
    name_ = name;
  }

 protected:
  Result<bool> read_next(EventBatch& batch, size_t max_events) override {
    const size_t begin = batch.events.size();
    if (next_ == events_.size() && gate_.restart() && !parts_end_) {
      // The rest of the earlier part's triggers.
      const size_t before = batch.triggers.size();
      E2LF_ASSIGN_OR_RETURN(parts_end_, take_rest(batch, max_events));
      parts_end_ |= batch.triggers.size() == before;  // what is left belongs to a later part
      return true;
    }
    if (std::exchange(parts_end_, false)) begin_later_part();
    bool more = true;
    if (next_ == events_.size()) E2LF_RETURN_IF_ERROR(read_block(more));
    if (next_ == 0 && begin == 0 && events_.size() <= max_events) {
      std::swap(batch.events, events_);
      events_.clear();
      return take_beside(batch, begin, more, max_events);
    }
    const size_t end = std::min(events_.size(), next_ + max_events);
    batch.events.append(events_, next_, end);
    next_ = end;
    more |= next_ < events_.size();
    return take_beside(batch, begin, more, max_events);
  }

  Result<void> seek_before(int64_t t_us) override {
    E2LF_RETURN_IF_ERROR(blocks_->seek_before(t_us));
    events_.clear();
    next_ = 0;
    triggers_.clear();
    last_trigger_us_ = -kTimeLimitUs;
    has_ended_ = parts_end_ = false;
    gate_.reset();
    return triggers_apart_.rewind();
  }

 private:
  Result<void> read_block(bool& more) {
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
    more = !has_ended_ || gate_.restart();
    return {};
  }

  void begin_later_part() {
    const Restart restart = *gate_.restart();
    gate_.begin_part();
    triggers_apart_.begin_part();
    last_trigger_us_ = -kTimeLimitUs;
    begin_part(restart.byte, restart.before_us);
  }

  /// Hands out the triggers that are left of a part whose events have all been; whether that is all of them.
  Result<bool> take_rest(EventBatch& batch, size_t max_triggers) {
    if (take_triggers(batch, INT64_MAX, max_triggers) || batch.triggers.size() >= max_triggers) return false;
    E2LF_ASSIGN_OR_RETURN(const bool more, triggers_apart_.take(INT64_MAX, max_triggers - batch.triggers.size(),
                                                                batch.triggers, summary_));
    return !more || triggers_apart_.is_at_restart();
  }

  Result<bool> take_beside(EventBatch& batch, size_t begin, bool more, size_t max_triggers) {
    if (!more) triggers_apart_.end_parts();
    // At the end, triggers may need several batches.
    if (!more || batch.events.size() > begin) {
      more |= take_triggers(batch, more ? batch.events.t.back() : INT64_MAX, max_triggers);
    }
    if (batch.triggers.size() >= max_triggers) return more;
    return triggers_apart_.take_beside(batch, begin, more, max_triggers - batch.triggers.size(), summary_);
  }

  /// Hands out the triggers up to a time; whether there was no room for all. Those of a later part wait for it.
  bool take_triggers(EventBatch& batch, int64_t until_us, size_t max_triggers) {
    for (size_t taken = 0; !triggers_.empty() && triggers_.front().t <= until_us; ++taken) {
      if (taken == max_triggers) return true;
      if (triggers_.front().t < last_trigger_us_) {
        const bool is_last_part = has_ended_ && !gate_.restart();
        const bool is_stray = triggers_.size() > 1 && triggers_[1].t >= last_trigger_us_;
        if (!is_last_part && !is_stray) return false;
        summary_.add(Violation::kTimeBackwards, 0);
        triggers_.pop_front();
        continue;
      }
      last_trigger_us_ = triggers_.front().t;
      batch.triggers.push_back(triggers_.front());
      triggers_.pop_front();
    }
    return false;
  }

  std::unique_ptr<EventBlocks> blocks_;
  TriggerFeed triggers_apart_;
  EventGate gate_;
  EventBatch block_;
  EventColumns events_;  ///< believable and not yet handed out, from next_ on
  size_t next_ = 0;
  std::deque<Trigger> triggers_;
  int64_t last_trigger_us_ = -kTimeLimitUs;  ///< of those handed out in this part
  bool has_ended_ = false;                   ///< there are no more blocks
  bool parts_end_ = false;                   ///< a part has been handed out whole, and another one follows
};

}  // namespace

std::unique_ptr<RecordingReader> make_block_reader(std::unique_ptr<EventBlocks> blocks, RecordingInfo info,
                                                   const std::string& name, const OpenOptions& options,
                                                   TriggerFeed triggers) {
  return std::make_unique<BlockReader>(std::move(blocks), std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::recordings
