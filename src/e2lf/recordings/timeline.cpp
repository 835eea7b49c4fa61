// SPDX-License-Identifier: MIT
#include "e2lf/recordings/timeline.h"

#include <algorithm>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/recordings/batch_check.h"

namespace e2lf::recordings {
namespace {

/// Number of successors with which the time of an event is compared.
constexpr size_t kTimeLookAhead = 16;

/// Minimum number of times before and after a restart of the clock.
constexpr size_t kMinRestartWitnesses = 8;

/// Events that wait beyond this number are returned, which limits the memory for events of equal times.
constexpr size_t kMaxWaiting = size_t{1} << 22;

/// Blocks of fewer events are joined.
constexpr size_t kSmallBlock = 4096;

/// Largest number of triggers that are returned at once.
constexpr size_t kMaxTriggers = size_t{1} << 16;

/// Number of events after a trigger whose time decreases until its part is known.
constexpr uint64_t kTriggerWait = size_t{1} << 14;

/// Returns true if values rise or fall, but not if all are equal.
bool is_sorted_by(std::span<const uint16_t> values) {
  if (values.front() == values.back()) return false;
  return std::is_sorted(values.begin(), values.end()) || std::is_sorted(values.rbegin(), values.rend());
}

/// Returns true if most of the next times, not counting those before `earliest_us`, are earlier than time i by more
/// than kDisorderUs.
template <typename TimeAt>
bool is_ahead_of_successors(size_t i, size_t count, int64_t earliest_us, const TimeAt& time_at) {
  const int64_t t_us = time_at(i);
  size_t earlier = 0, counted = 0;
  for (size_t j = i + 1; j < std::min(count, i + 1 + kTimeLookAhead); ++j) {
    const int64_t successor_us = time_at(j);
    counted += successor_us >= earliest_us;
    earlier += successor_us >= earliest_us && successor_us < t_us - kDisorderUs;
  }
  return 2 * earlier > counted;
}

/// Returns true if the clock starts again at time i of `count`, whose predecessor is last_us: the time decreases by
/// more than kDisorderUs, and three quarters of the next kRestartWitnesses times continue from it, that is, they do not
/// decrease and are before last_us. Returns false if fewer than `fewest` times follow.
template <typename TimeAt>
bool is_restart(size_t i, size_t count, int64_t last_us, const TimeAt& time_at, size_t fewest) {
  const int64_t first_us = time_at(i);
  if (first_us >= last_us - kDisorderUs) return false;
  const size_t considered = std::min(count - i - 1, kRestartWitnesses);
  size_t in_favour = 0;
  int64_t latest_us = first_us;
  for (size_t k = i + 1; k <= i + considered; ++k) {
    const int64_t t_us = time_at(k);
    if (t_us < latest_us - kDisorderUs || t_us >= last_us) continue;
    ++in_favour;
    latest_us = std::max(latest_us, t_us);
  }
  // A run of equal times, for example of zeroed bytes, is not a running clock.
  const bool runs = latest_us > first_us || considered == 0;
  return considered >= fewest && 4 * in_favour >= 3 * considered && runs;
}

/// Sorts events by time; the order of events with equal times is preserved.
void sort_by_time(EventColumns& events) {
  if (std::is_sorted(events.t.begin(), events.t.end())) return;
  std::vector<Event> records(events.size());
  for (size_t i = 0; i < events.size(); ++i) records[i] = events[i];
  std::stable_sort(records.begin(), records.end(), [](const Event& a, const Event& b) { return a.t < b.t; });
  for (size_t i = 0; i < records.size(); ++i) events.set(i, records[i]);
}

/// Appends the last times of a column, and limits the whole to as many as starts_again() may need.
void append_recent(const Column<int64_t>& times_us, size_t begin, size_t end, std::vector<int64_t>& recent_us) {
  constexpr size_t kMost = 2 * kRestartWitnesses;
  const size_t from = end - std::min(end - begin, kMost);
  recent_us.insert(recent_us.end(), times_us.begin() + static_cast<ptrdiff_t>(from),
                   times_us.begin() + static_cast<ptrdiff_t>(end));
  if (recent_us.size() > kMost) recent_us.erase(recent_us.begin(), recent_us.end() - kMost);
}

}  // namespace

Timeline::Timeline(BlocksPtr blocks, BlocksPtr triggers, size_t width, size_t height, std::string name)
    : blocks_(std::move(blocks)),
      width_(width),
      height_(height),
      name_(std::move(name)),
      has_ended_(blocks_ == nullptr),
      source_(std::move(triggers)),
      has_more_triggers_(source_ != nullptr) {}

Result<bool> Timeline::next(EventBatch& batch, DecodeSummary& summary) {
  if (blocks_ != nullptr && blocks_->is_ordered()) return pass_on(batch, summary);
  batch.clear();
  for (;;) {
    const bool has_section = !sections_.empty() && is_complete(sections_.front());
    if (has_section && sections_.front().part == part_) {
      hand_out(batch);
      E2LF_RETURN_IF_ERROR(take_triggers(batch.events.t.back(), batch, summary));
      return true;
    }
    if (!has_section && !has_ended_) {
      E2LF_RETURN_IF_ERROR(read_block(summary));
      continue;
    }
    // The events of this part were returned; its last triggers remain.
    E2LF_RETURN_IF_ERROR(take_triggers(INT64_MAX, batch, summary));
    if (!batch.empty()) return true;
    if (part_ == part_bytes_.size()) return false;
    begin_later_part();
  }
}

Result<bool> Timeline::pass_on(EventBatch& batch, DecodeSummary& summary) {
  E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(batch, summary));
  if (blocks_->begins_recording()) {
    part_bytes_.push_back(blocks_->block_byte());
    begin_later_part();
  }
  last_us_ = std::max(last_us_, batch.last_us());
  return more;
}

/// Returns true if no event can precede the end of a section any more.
bool Timeline::is_complete(const Section& section) const {
  if (has_ended_ || section.part < part_bytes_.size()) return true;
  if (latest_us_ != INT64_MIN && section.events.t.back() <= latest_us_ - kDisorderUs) return true;
  return num_waiting_ > kMaxWaiting && sections_.size() > 1 && section.events.t.back() <= latest_us_;
}

/// Exchanges the empty batch for the first section.
void Timeline::hand_out(EventBatch& batch) {
  std::swap(batch.events, sections_.front().events);
  constexpr size_t kMostSpare = 4;
  if (spare_.size() < kMostSpare) spare_.push_back(std::move(sections_.front().events));
  sections_.pop_front();
  num_waiting_ -= batch.events.size();
  last_us_ = std::max(last_us_, batch.events.t.back());
  if (part_ == part_bytes_.size()) floor_us_ = batch.events.t.back();
}

void Timeline::begin_later_part() {
  const uint64_t byte = part_bytes_[part_++];
  // A part without plausible events and triggers does not separate those around it.
  if (last_us_ != INT64_MIN) restart_ = Restart{byte, last_us_};
  last_us_ = INT64_MIN;
  if (trigger_part_ < part_) {
    trigger_part_ = part_;
    last_trigger_us_ = INT64_MIN;
  }
}

Result<void> Timeline::read_block(DecodeSummary& summary) {
  block_.clear();
  E2LF_ASSIGN_OR_RETURN(const bool more, blocks_->next(block_, summary));
  has_ended_ = !more;
  if (blocks_->begins_recording()) {
    E2LF_RETURN_IF_ERROR(judge(/*is_end=*/true, summary));
    end_part(blocks_->block_byte());
  }
  for (const Trigger& trigger : block_.triggers) triggers_.push_back({trigger, part_bytes_.size(), num_read_});
  num_read_ += block_.events.size();
  if (unjudged_.empty() && continues(block_.events)) {
    add_in_order(block_.events);
  } else {
    reopen();
    add_unordered(block_.events, summary);
  }
  return has_ended_ || !unjudged_.empty() ? judge(has_ended_, summary) : Result<void>{};
}

/// Returns true if events are plausible and not earlier than those before them.
bool Timeline::continues(const EventColumns& events) const {
  if (events.empty()) return true;
  return events.t.front() >= newest_us_ && is_time(events.t.front()) && is_time(events.t.back()) &&
         is_in_order(events, width_, height_);
}

/// Appends events that continue those before them. The last ones are open: their successors are not known yet.
void Timeline::add_in_order(EventColumns& events) {
  const size_t count = events.size();
  if (count == 0) return;
  if (!has_on_ || !has_off_) {
    const uint64_t on = count_on(events.p);
    has_on_ |= on > 0;
    has_off_ |= on < count;
  }
  append_recent(events.t, 0, count, recent_us_);
  newest_us_ = events.t.back();
  num_waiting_ += count;
  num_judged_ += num_open_ + count;
  num_open_ = std::min(num_open_ + count, kRestartWitnesses);
  num_judged_ -= num_open_;
  const bool is_joined = !sections_.empty() && sections_.back().part == part_bytes_.size() && count < kSmallBlock &&
                         sections_.back().events.size() < kSmallBlock &&
                         sections_.back().events.t.front() >= newest_us_ - kDisorderUs;
  if (is_joined) {
    sections_.back().events.append(events);
  } else {
    sections_.push_back({std::move(events), part_bytes_.size()});
    events = {};
    if (!spare_.empty()) {
      events = std::move(spare_.back());
      spare_.pop_back();
    }
  }
  // The latest judged event precedes the open ones.
  size_t after = num_open_;
  for (auto section = sections_.rbegin(); section != sections_.rend() && section->part == part_bytes_.size();
       ++section) {
    if (section->events.size() > after) {
      latest_us_ = std::max(latest_us_, section->events.t[section->events.size() - 1 - after]);
      break;
    }
    after -= section->events.size();
  }
}

/// Moves the open events back to those that are not judged, because what follows is not in order.
void Timeline::reopen() {
  recent_us_.resize(recent_us_.size() - num_open_);
  num_waiting_ -= num_open_;
  while (num_open_ > 0) {
    EventColumns& last = sections_.back().events;
    const size_t count = std::min(num_open_, last.size());
    EventColumns front;
    front.append(last, last.size() - count, last.size());
    front.append(unjudged_);
    std::swap(unjudged_, front);
    last.resize(last.size() - count);
    if (last.empty()) sections_.pop_back();
    num_open_ -= count;
  }
}

/// Appends events to unjudged_, except those with impossible times.
void Timeline::add_unordered(const EventColumns& events, DecodeSummary& summary) {
  if (std::all_of(events.t.begin(), events.t.end(), is_time)) return unjudged_.append(events);
  for (size_t i = 0; i < events.size(); ++i) {
    if (is_time(events.t[i])) {
      unjudged_.push_back(events[i]);
    } else {
      summary.add_dropped(Violation::kTimeJump, blocks_->block_byte() + i * blocks_->event_bytes());
    }
  }
}

/// Returns the position in the file of an event in unjudged_, whose last ones are those of the last block.
uint64_t Timeline::byte_of(size_t i) const {
  const uint64_t begin = blocks_->block_byte(),
                 before = unjudged_.size() - std::min(unjudged_.size(), block_.events.size());
  const uint64_t lag = blocks_->event_bytes() * before;
  return begin - std::min(begin, lag) + blocks_->event_bytes() * i;
}

/// Judges the events whose successors are known, or all of them at an end.
Result<void> Timeline::judge(bool is_end, DecodeSummary& summary) {
  if (is_end) num_judged_ += std::exchange(num_open_, 0);
  const size_t count = unjudged_.size(), end = is_end ? count : count - std::min(count, kRestartWitnesses);
  size_t begin = 0;  // of the part
  judged_.clear();
  for (size_t i = 0; i < end; ++i) {
    const int64_t t_us = unjudged_.t[i];
    const int64_t before_us = i > begin ? unjudged_.t[i - 1] : recent_us_.empty() ? t_us : recent_us_.back();
    if (t_us < before_us - kDisorderUs && starts_again(begin, i)) {
      add_judged();
      end_part(blocks_->event_bytes() == 0 ? 0 : byte_of(i));
      begin = i;
    }
    ++num_judged_;
    if (const auto violation = fault(i)) {
      summary.add_dropped(*violation, byte_of(i));
      num_late_ += *violation == Violation::kTimeBackwards;
      E2LF_RETURN_IF_ERROR(refuse_disorder(/*is_end=*/false));
      continue;
    }
    summary.out_of_order += t_us < latest_us_;
    latest_us_ = std::max(latest_us_, t_us);
    (unjudged_.p[i] != 0 ? has_on_ : has_off_) = true;
    judged_.push_back(unjudged_[i]);
  }
  add_judged();
  append_recent(unjudged_.t, begin, end, recent_us_);
  unjudged_.erase(0, end);
  newest_us_ = latest_us_;
  if (is_end) return has_ended_ ? refuse_disorder(/*is_end=*/true) : Result<void>{};
  if (continues(unjudged_)) {
    add_in_order(unjudged_);
    unjudged_.clear();
  }
  return {};
}

/// Returns what is implausible about an event.
std::optional<Violation> Timeline::fault(size_t i) const {
  if ((width_ != 0 && unjudged_.x[i] >= width_) || (height_ != 0 && unjudged_.y[i] >= height_))
    return Violation::kOutOfRange;
  const int64_t t_us = unjudged_.t[i];
  const int64_t earliest_us = latest_us_ == INT64_MIN ? INT64_MIN : std::max(latest_us_ - kDisorderUs, floor_us_);
  if (t_us < earliest_us) return Violation::kTimeBackwards;
  // Only an event that is far ahead of those before it can be far ahead of those after it.
  if (t_us - kDisorderUs <= latest_us_) return std::nullopt;
  const auto time_at = [this](size_t k) { return unjudged_.t[k]; };
  const bool is_ahead = is_ahead_of_successors(i, unjudged_.size(), earliest_us, time_at);
  return is_ahead ? std::optional(Violation::kTimeJump) : std::nullopt;
}

/// Merges judged_ with the sections of the part that are later.
void Timeline::add_judged() {
  if (judged_.empty()) return;
  sort_by_time(judged_);
  num_waiting_ += judged_.size();
  EventColumns merged;
  size_t from = sections_.size();
  while (from > 0 && sections_[from - 1].part == part_bytes_.size() &&
         sections_[from - 1].events.t.back() > judged_.t.front()) {
    --from;
  }
  for (size_t i = from; i < sections_.size(); ++i) merged.append(sections_[i].events);
  sections_.resize(from);
  merged.append(judged_);
  sort_by_time(merged);
  sections_.push_back({std::move(merged), part_bytes_.size()});
  judged_.clear();
}

/// Returns the last kRestartWitnesses times before event i of the part that begins at `begin`.
std::vector<int64_t> Timeline::times_before(size_t begin, size_t i) const {
  std::vector<int64_t> times_us;
  if (begin == 0) times_us = recent_us_;
  append_recent(unjudged_.t, begin, i, times_us);
  const size_t surplus = times_us.size() - std::min(times_us.size(), kRestartWitnesses);
  times_us.erase(times_us.begin(), times_us.begin() + static_cast<ptrdiff_t>(surplus));
  return times_us;
}

/// Returns true if the clock starts again at event i of unjudged_, of the part that begins at `begin`.
bool Timeline::starts_again(size_t begin, size_t i) const {
  std::vector<int64_t> times_us = times_before(begin, i);
  if (part_bytes_.size() == DecodeSummary::kMaxGaps || times_us.size() < kMinRestartWitnesses) return false;
  // A few damaged times on either side are not sufficient, nor is a run of equal times, for example of zeroed bytes.
  if (times_us.front() == times_us.back()) return false;
  size_t rising = 1, later = 0;
  for (size_t k = 1; k < times_us.size(); ++k) rising += times_us[k] >= times_us[k - 1] - kDisorderUs;
  for (const int64_t t_us : times_us) later += t_us > unjudged_.t[i] + kDisorderUs;
  if (4 * rising < 3 * times_us.size() || 4 * later < 3 * times_us.size()) return false;
  const auto last = times_us.end() - 1 - static_cast<ptrdiff_t>(times_us.size() / 8);
  std::nth_element(times_us.begin(), last, times_us.end());
  const auto time_at = [this](size_t k) { return unjudged_.t[k]; };
  if (!is_restart(i, unjudged_.size(), *last, time_at, kMinRestartWitnesses)) return false;
  // Events may be sorted by row, column or polarity rather than by time.
  const size_t count = std::min(unjudged_.size() - i, kRestartWitnesses);
  const uint64_t on = count_on(std::span(unjudged_.p).subspan(i, count));
  const bool is_other_polarity = (has_on_ && !has_off_ && on == 0) || (has_off_ && !has_on_ && on == count);
  const size_t from = i - (i > begin ? 1 : 0), with_last = i + count - from;
  return !is_other_polarity && !is_sorted_by(std::span(unjudged_.x).subspan(from, with_last)) &&
         !is_sorted_by(std::span(unjudged_.y).subspan(from, with_last));
}

/// Begins a later part for the events that follow.
void Timeline::end_part(uint64_t byte) {
  part_bytes_.push_back(byte);
  recent_us_.clear();
  latest_us_ = newest_us_ = floor_us_ = INT64_MIN;
  has_on_ = has_off_ = false;
}

/// Fails if the share of events that are too early shows that the recording is not in order of time.
Result<void> Timeline::refuse_disorder(bool is_end) const {
  constexpr uint64_t kFew = 8, kMany = 1000;
  if (num_late_ < (is_end ? kFew : kMany) || 4 * num_late_ < num_judged_) return {};
  return fail(ErrorCode::kFormat, name_, num_late_, " of the first ", num_judged_, " events are more than ",
              kDisorderUs / 1000, " ms earlier than an event before them; sort the recording by time");
}

Result<void> Timeline::refill_triggers(DecodeSummary& summary) {
  while (has_more_triggers_ && triggers_.size() <= kRestartWitnesses) {
    E2LF_ASSIGN_OR_RETURN(has_more_triggers_, source_->next(from_source_, summary));
    for (const Trigger& trigger : from_source_.triggers) triggers_.push_back({trigger});
  }
  return {};
}

/// Returns true if the decrease of the time of the first trigger may be a restart of the clock.
bool Timeline::fall_may_be_restart() const {
  if (source_ == nullptr)
    return part_bytes_.size() > trigger_part_ || num_read_ < triggers_.front().position + kTriggerWait;
  const auto time_at = [this](size_t i) { return triggers_[i].trigger.t; };
  // Triggers are few, so that a decreasing one at the end may be the only trigger of the later part.
  return is_restart(0, triggers_.size(), last_trigger_us_, time_at, 0);
}

bool Timeline::is_trigger_ahead() const {
  const auto time_at = [this](size_t i) { return triggers_[i].trigger.t; };
  return source_ != nullptr && is_ahead_of_successors(0, triggers_.size(), last_trigger_us_, time_at);
}

/// Appends the triggers of this part with t <= until_us.
Result<void> Timeline::take_triggers(int64_t until_us, EventBatch& batch, DecodeSummary& summary) {
  for (; batch.triggers.size() < kMaxTriggers;) {
    E2LF_RETURN_IF_ERROR(refill_triggers(summary));
    if (triggers_.empty()) return {};
    auto [trigger, part, position] = triggers_.front();
    if (part > trigger_part_) {
      trigger_part_ = part;
      last_trigger_us_ = INT64_MIN;
    }
    const bool falls = last_trigger_us_ != INT64_MIN && trigger.t < last_trigger_us_ - kDisorderUs;
    if (falls && fall_may_be_restart()) {
      // In a recording without events, the triggers alone show where the clock starts again.
      if (has_ended_ && num_read_ == 0 && trigger_part_ == part_bytes_.size()) part_bytes_.push_back(0);
      if (trigger_part_ < part_bytes_.size()) {
        ++trigger_part_;
        last_trigger_us_ = INT64_MIN;
      } else if (!has_ended_) {
        return {};
      }
    }
    if (trigger_part_ > part_) return {};
    const bool is_late = last_trigger_us_ != INT64_MIN && trigger.t < last_trigger_us_ - kDisorderUs;
    if (is_late || !is_time(trigger.t) || is_trigger_ahead()) {
      summary.add_dropped(is_late ? Violation::kTimeBackwards : Violation::kTimeJump, 0);
      triggers_.pop_front();
      continue;
    }
    if (trigger.t > until_us) return {};
    trigger.t = last_trigger_us_ = std::max(trigger.t, last_trigger_us_);
    last_us_ = std::max(last_us_, trigger.t);
    batch.triggers.push_back(trigger);
    triggers_.pop_front();
  }
  return {};
}

Result<void> Timeline::seek_before(int64_t t_us) {
  // Events from t_us on may precede others that are earlier by up to kDisorderUs.
  const bool is_ordered = blocks_ != nullptr && blocks_->is_ordered();
  if (!is_ordered && t_us > -kTimeLimitUs) t_us -= kDisorderUs;
  if (blocks_ != nullptr) E2LF_RETURN_IF_ERROR(blocks_->seek_before(t_us));
  if (source_ != nullptr) E2LF_RETURN_IF_ERROR(source_->seek_before(INT64_MIN));
  *this = Timeline(std::move(blocks_), std::move(source_), width_, height_, std::move(name_));
  return {};
}

}  // namespace e2lf::recordings
