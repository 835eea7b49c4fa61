// SPDX-License-Identifier: MIT
// Continues the times of recordings whose clock restarts; declared in restart.h.
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/restart.h"

namespace e2lf::recordings {
namespace {

template <typename T>
bool is_monotonic(std::span<const T> values) {
  return std::is_sorted(values.begin(), values.end()) || std::is_sorted(values.rbegin(), values.rend());
}

class ContinuedClock final : public EventBlocks {
 public:
  ContinuedClock(BlocksPtr blocks, EventOrder order) : blocks_(std::move(blocks)), order_(order) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    if (!has_ended_) {
      E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block, summary));
      has_ended_ = !more;
    }
    block_byte_ = blocks_->block_byte();
    drop_impossible_times(block, summary);
    if (block_byte_ != 0) block_byte_ -= waiting_.size() * event_bytes();
    if (!waiting_.empty()) {
      waiting_.append(block.events);
      std::swap(waiting_, block.events);
      waiting_.clear();
    }
    const size_t known_parts = restarts_.size();
    continue_events(block.events);
    continue_triggers(block, known_parts);
    return !has_ended_ || !block.empty();
  }

  std::span<const Restart> restarts() const override { return restarts_; }
  uint64_t block_byte() const override { return block_byte_; }
  size_t event_bytes() const override { return blocks_->event_bytes(); }

  /// The blocks can only seek by the clock of the first part.
  Result<void> seek_before(int64_t t_us) override {
    has_restarted_ |= !restarts_.empty();
    restarts_.clear();
    waiting_.clear();
    waiting_triggers_.clear();
    begin_part();
    last_trigger_us_ = INT64_MIN;
    trigger_part_ = 0;
    has_ended_ = false;
    return blocks_->seek_before(has_restarted_ ? INT64_MIN : t_us);
  }

 private:
  [[nodiscard]] int64_t shift_us() const { return restarts_.empty() ? 0 : restarts_.back().shift_us; }

  /// Drops events and triggers whose times could not be shifted without overflow.
  void drop_impossible_times(EventBatch& block, DecodeSummary& summary) const {
    EventColumns& events = block.events;
    bool are_possible = true;
    for (const int64_t t_us : events.t) are_possible &= is_time(t_us);
    const auto is_impossible = [](const Trigger& trigger) { return !is_time(trigger.t); };
    size_t dropped = std::erase_if(block.triggers, is_impossible);
    if (!are_possible) {
      EventColumns possible;
      for (size_t i = 0; i < events.size(); ++i) {
        if (is_time(events.t[i])) possible.push_back(events[i]);
      }
      dropped += events.size() - possible.size();
      events = std::move(possible);
    }
    if (dropped > 0) summary.add(Violation::kTimeJump, block_byte_, dropped);
  }

  void begin_part() {
    history_.clear();
    has_on_ = has_off_ = false;
  }

  /// Shifts the times of later parts. Withholds an event that may begin a part until enough events follow it.
  void continue_events(EventColumns& events) {
    size_t begin = 0, end = events.size();
    for (size_t i = find_fall(events.t, 0); i < end; i = find_fall(events.t, i + 1)) {
      if (!has_ended_ && events.size() - i - 1 < kRestartWitnesses) {
        waiting_.append(events, i, events.size());
        end = i;
        break;
      }
      accept(events, begin, i);
      begin = i;
      if (!starts_again(events, i) || !is_time(shift_us() + history_.back())) continue;
      const uint64_t byte = event_bytes() == 0 ? 0 : block_byte_ + i * event_bytes();
      const int64_t before_us = history_.back();
      restarts_.push_back({byte, before_us, events.t[i], shift_us() + before_us + 1 - events.t[i]});
      begin_part();
    }
    accept(events, begin, end);
    events.resize(end);
  }

  /// Adds events to the current part.
  void accept(EventColumns& events, size_t begin, size_t end) {
    if (begin == end) return;
    if (order_ == EventOrder::kAny && !(has_on_ && has_off_)) {
      const auto count_on = std::count(&events.p[begin], &events.p[begin] + (end - begin), 1);
      has_on_ |= count_on > 0;
      has_off_ |= static_cast<size_t>(count_on) < end - begin;
    }
    const size_t noted = std::min(end - begin, kRestartWitnesses);
    const size_t stale = history_.size() - std::min(history_.size(), kRestartWitnesses - noted);
    history_.erase(history_.begin(), history_.begin() + static_cast<ptrdiff_t>(stale));
    history_.insert(history_.end(), &events.t[end - noted], &events.t[end - noted] + noted);
    if (const int64_t moved_us = shift_us(); moved_us != 0) {
      for (size_t i = begin; i < end; ++i) events.t[i] += moved_us;
    }
  }

  /// Returns true if the clock starts again at event i, whose time is before those in history_.
  [[nodiscard]] bool starts_again(const EventColumns& events, size_t i) const {
    if (restarts_.size() == DecodeSummary::kMaxGaps || history_.size() < kMinRestartWitnesses) return false;
    // A few damaged times on either side are not sufficient, nor is a run of equal times, for example of zeroed bytes.
    if (history_.front() == history_.back()) return false;
    size_t rising = 1, later = 0;
    for (size_t k = 1; k < history_.size(); ++k) rising += history_[k] >= history_[k - 1];
    for (const int64_t t_us : history_) later += t_us >= events.t[i] + kMinRestartUs;
    if (4 * rising < 3 * history_.size() || 4 * later < 3 * history_.size()) return false;
    std::vector<int64_t> times_us = history_;
    const auto last = times_us.end() - 1 - static_cast<ptrdiff_t>(times_us.size() / 8);
    std::nth_element(times_us.begin(), last, times_us.end());
    const auto time_at = [&](size_t k) { return events.t[k]; };
    return is_restart(i, events.size(), *last, time_at) &&
           (order_ == EventOrder::kByTime || !is_sorted_otherwise(events, i));
  }

  /// Returns true if the events after a decrease are sorted by row, column or polarity rather than by time.
  [[nodiscard]] bool is_sorted_otherwise(const EventColumns& events, size_t i) const {
    const size_t count = std::min(events.size() - i, kRestartWitnesses);
    const auto on = std::count(&events.p[i], &events.p[i] + count, 1);
    const bool is_other_polarity =
        (has_on_ && !has_off_ && on == 0) || (has_off_ && !has_on_ && on == static_cast<ptrdiff_t>(count));
    return is_other_polarity || is_monotonic(std::span<const uint16_t>(&events.x[i], count)) ||
           is_monotonic(std::span<const uint16_t>(&events.y[i], count));
  }

  /// Shifts the triggers of later parts. Triggers whose time decreases earlier than that of the events are withheld for
  /// at most kMostBlocks blocks.
  void continue_triggers(EventBatch& block, size_t known_parts) {
    if (waiting_triggers_.empty() && block.triggers.empty()) return;
    waiting_triggers_.insert(waiting_triggers_.end(), block.triggers.begin(), block.triggers.end());
    block.triggers.clear();
    // The triggers of a block after the one with the first event of a part belong to that part.
    trigger_part_ = std::max(trigger_part_, known_parts);
    size_t taken = 0;
    for (const Trigger& trigger : waiting_triggers_) {
      const bool falls = trigger.t < last_trigger_us_ && last_trigger_us_ - trigger.t >= kMinRestartUs;
      if (falls && trigger_part_ < restarts_.size())
        ++trigger_part_;
      else if (falls && trigger_part_ == known_parts && !has_ended_ && blocks_waited_ < kMostBlocks)
        break;
      last_trigger_us_ = trigger.t;
      const int64_t moved_us = trigger_part_ == 0 ? 0 : restarts_[trigger_part_ - 1].shift_us;
      block.triggers.push_back({trigger.t + moved_us, trigger.id, trigger.p});
      ++taken;
    }
    waiting_triggers_.erase(waiting_triggers_.begin(), waiting_triggers_.begin() + static_cast<ptrdiff_t>(taken));
    blocks_waited_ = taken > 0 || waiting_triggers_.empty() ? 0 : blocks_waited_ + 1;
  }

  /// Returns the first event at or after `from` whose time decreases by kMinRestartUs or more.
  [[nodiscard]] size_t find_fall(const Column<int64_t>& t, size_t from) const {
    constexpr size_t kStep = 512;
    if (from == 0 && !t.empty()) {
      if (!history_.empty() && t[0] <= history_.back() - kMinRestartUs) return 0;
      from = 1;
    }
    for (; from < t.size(); from += kStep) {
      const size_t end = std::min(t.size(), from + kStep);
      int64_t deepest_us = 0;
      for (size_t i = from; i < end; ++i) deepest_us = std::min(deepest_us, t[i] - t[i - 1]);
      if (deepest_us > -kMinRestartUs) continue;
      for (size_t i = from; i < end; ++i) {
        if (t[i] - t[i - 1] <= -kMinRestartUs) return i;
      }
    }
    return t.size();
  }

  static constexpr int kMostBlocks = 4;

  BlocksPtr blocks_;
  EventOrder order_;
  std::vector<Restart> restarts_;
  std::vector<int64_t> history_;           ///< the last times of the current part, before the shift
  bool has_on_ = false, has_off_ = false;  ///< whether this part has such events
  EventColumns waiting_;
  std::vector<Trigger> waiting_triggers_;
  int blocks_waited_ = 0;                ///< number of blocks for which triggers were withheld
  int64_t last_trigger_us_ = INT64_MIN;  ///< before the shift
  size_t trigger_part_ = 0;              ///< number of restarts before the next triggers
  uint64_t block_byte_ = 0;
  bool has_restarted_ = false, has_ended_ = false;
};

}  // namespace

BlocksPtr make_continued(BlocksPtr blocks, EventOrder order) {
  return std::make_unique<ContinuedClock>(std::move(blocks), order);
}

}  // namespace e2lf::recordings
