// SPDX-License-Identifier: MIT
#include <algorithm>
#include <deque>

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
        gate_(info.width, info.height, 0) {
    info_ = std::move(info);
    name_ = name;
  }

 protected:
  Result<bool> read_next(EventBatch& batch, size_t max_events) override {
    const size_t begin = batch.events.size();
    bool more = true;
    if (next_ == events_.size()) E2LF_RETURN_IF_ERROR(read_block(more));
    const size_t end = std::min(events_.size(), next_ + max_events);
    batch.events.append(events_, next_, end);
    next_ = end;
    // At the end, triggers may need several batches.
    more |= take_triggers(batch, begin, more, max_events);
    if (batch.triggers.size() >= max_events) return more;
    return triggers_apart_.take_beside(batch, begin, more, max_events - batch.triggers.size(), summary_);
  }

  Result<void> seek_before(int64_t t_us) override {
    E2LF_RETURN_IF_ERROR(blocks_->seek_before(t_us));
    events_.clear();
    next_ = 0;
    triggers_.clear();
    last_trigger_us_ = -kTimeLimitUs;
    gate_.reset();
    return triggers_apart_.rewind();
  }

 private:
  Result<void> read_block(bool& more) {
    E2LF_ASSIGN_OR_RETURN(more, blocks_->next(block_, summary_));
    events_.clear();
    next_ = 0;
    gate_.release(events_);
    events_.append(block_.events);
    gate_.filter(events_, 0, !more, 0, summary_);
    for (const Trigger& trigger : block_.triggers) {
      if (trigger.t < last_trigger_us_ || !is_time(trigger.t)) {
        summary_.add(Violation::kTimeBackwards, 0);
        continue;
      }
      last_trigger_us_ = trigger.t;
      triggers_.push_back(trigger);
    }
    return {};
  }

  /// Hands out the triggers up to the last event of the batch, or the rest at the end; whether some are left then.
  bool take_triggers(EventBatch& batch, size_t begin, bool more_events, size_t max_triggers) {
    if (more_events && batch.events.size() == begin) return false;
    const int64_t until_us = more_events ? batch.events.t.back() : INT64_MAX;
    for (size_t taken = 0; !triggers_.empty() && triggers_.front().t <= until_us; ++taken) {
      if (taken == max_triggers) return true;
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
  int64_t last_trigger_us_ = -kTimeLimitUs;
};

}  // namespace

std::unique_ptr<RecordingReader> make_block_reader(std::unique_ptr<EventBlocks> blocks, RecordingInfo info,
                                                   const std::string& name, const OpenOptions& options,
                                                   TriggerFeed triggers) {
  return std::make_unique<BlockReader>(std::move(blocks), std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::recordings
