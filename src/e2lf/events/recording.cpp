// SPDX-License-Identifier: MIT
#include "e2lf/events/recording.h"

#include <algorithm>
#include <numeric>

#include "e2lf/base/contract.h"
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"

namespace e2lf::events {
namespace {

int16_t add_saturated(int16_t count, int step) {
  return static_cast<int16_t>(std::clamp(count + step, -32768, 32767));
}

/// Index of the first time in [begin, size) that is at or after `t_us`; times need not be sorted.
template <typename Times, typename TimeOf>
size_t first_at_or_after(const Times& times, size_t begin, int64_t t_us, const TimeOf& time_of) {
  while (begin < times.size() && time_of(times[begin]) < t_us) ++begin;
  return begin;
}

int64_t time_of_event(int64_t t) {
  return t;
}
int64_t time_of_trigger(const Trigger& trigger) {
  return trigger.t;
}

}  // namespace

std::optional<std::string> RecordingInfo::find(const std::string& key) const {
  for (const auto& [name, value] : header) {
    if (name == key) return value;
  }
  return std::nullopt;
}

bool RecordingReader::has_pending() const {
  return pending_event_ < pending_.events.size() || pending_trigger_ < pending_.triggers.size();
}

Result<bool> RecordingReader::refill_pending(size_t max_events) {
  pending_.clear();
  pending_event_ = pending_trigger_ = 0;
  E2LF_ASSIGN_OR_RETURN(const bool more, read_next(pending_, max_events));
  E2LF_RETURN_IF_ERROR(apply_policy());
  return more || has_pending();
}

void RecordingReader::take_pending(EventBatch& batch, size_t max_events) {
  const size_t event_end = std::min(pending_.events.size(), pending_event_ + max_events);
  size_t trigger_end = pending_.triggers.size();
  if (event_end < pending_.events.size()) {
    const int64_t end_us = pending_.events.t[event_end];
    trigger_end = first_at_or_after(pending_.triggers, pending_trigger_, end_us, time_of_trigger);
  }
  trigger_end = std::min(trigger_end, pending_trigger_ + max_events);
  batch.events.append(pending_.events, pending_event_, event_end);
  batch.triggers.insert(batch.triggers.end(), pending_.triggers.begin() + static_cast<ptrdiff_t>(pending_trigger_),
                        pending_.triggers.begin() + static_cast<ptrdiff_t>(trigger_end));
  pending_event_ = event_end;
  pending_trigger_ = trigger_end;
}

Result<void> RecordingReader::find_shift() {
  if (shift_us_) return {};
  if (options_.time == TimeOrigin::kAbsolute) {
    shift_us_ = 0;
    return {};
  }
  bool more = true;
  while (more && !has_pending()) {
    E2LF_ASSIGN_OR_RETURN(more, refill_pending(kMinBatch));
  }
  if (!has_pending()) return {};
  shift_us_ = pending_.events.empty()     ? pending_.triggers.front().t
              : pending_.triggers.empty() ? pending_.events.t.front()
                                          : std::min(pending_.events.t.front(), pending_.triggers.front().t);
  return {};
}

Result<void> RecordingReader::apply_policy() {
  for (size_t i = 0; i < kNumViolations; ++i) {
    const ViolationCount& violation = summary_.violations[i];
    const bool first = violation.count > 0 && known_violations_[i] == 0;
    known_violations_[i] = violation.count;
    if (!first) continue;
    if (options_.policy == DecodePolicy::kStrict) return violation_error(summary_, name_);
    if (options_.policy == DecodePolicy::kReport) {
      log_warning(cat(name_, ": byte ", violation.first_byte, ": ", violation_text(static_cast<Violation>(i)),
                      "; the damaged part is dropped"));
    }
  }
  return {};
}

void RecordingReader::count(const EventBatch& batch) {
  const size_t events = batch.events.size();
  summary_.triggers += batch.triggers.size();
  if (events == 0) return;
  if (summary_.events() == 0) summary_.first_t_us = batch.events.t.front();
  summary_.last_t_us = batch.events.t.back();
  const uint64_t on = std::accumulate(batch.events.p.begin(), batch.events.p.end(), uint64_t{0});
  summary_.events_on += on;
  summary_.events_off += events - on;
}

DecodeSummary RecordingReader::summary() const {
  DecodeSummary shifted = summary_;
  const int64_t shift_us = shift_us_.value_or(0);
  if (shifted.events() > 0) {
    shifted.first_t_us -= shift_us;
    shifted.last_t_us -= shift_us;
  }
  for (TimeGap& gap : shifted.gaps) {
    gap.begin_us -= shift_us;
    gap.end_us -= shift_us;
  }
  return shifted;
}

Result<bool> RecordingReader::read(EventBatch& batch, size_t max_events) {
  E2LF_REQUIRE(max_events >= kMinBatch, "a batch holds at least kMinBatch events");
  batch.clear();
  E2LF_RETURN_IF_ERROR(find_shift());
  if (has_pending()) {
    take_pending(batch, max_events);
  } else {
    bool more = true;
    while (more && batch.empty()) {
      E2LF_ASSIGN_OR_RETURN(more, read_next(batch, max_events));
      E2LF_RETURN_IF_ERROR(apply_policy());
    }
  }
  count(batch);
  if (const int64_t shift_us = shift_us_.value_or(0); shift_us != 0) {
    for (int64_t& t : batch.events.t) t -= shift_us;
    for (Trigger& trigger : batch.triggers) trigger.t -= shift_us;
  }
  return !batch.empty();
}

bool RecordingReader::accumulate_pending(std::span<const TimeSlice> slices, EventImages& images,
                                         std::vector<Trigger>* triggers) {
  const int64_t end_us = slices.back().end_us;
  const EventColumns& events = pending_.events;
  size_t slice = 0;
  size_t i = pending_event_;
  for (; i < events.size() && events.t[i] < end_us; ++i) {
    const Event event = events[i];
    while (event.t >= slices[slice].end_us) ++slice;
    if (summary_.events() == 0) summary_.first_t_us = event.t;
    summary_.last_t_us = event.t;
    ++(event.p != 0 ? summary_.events_on : summary_.events_off);
    if (event.t < slices[slice].begin_us || event.x >= images.width || event.y >= images.height) continue;
    int16_t& count = images.image(slice)[event.y * images.width + event.x];
    count = add_saturated(count, event.p != 0 ? 1 : -1);
  }
  pending_event_ = i;
  const size_t trigger_end = first_at_or_after(pending_.triggers, pending_trigger_, end_us, time_of_trigger);
  summary_.triggers += trigger_end - pending_trigger_;
  if (triggers != nullptr) {
    triggers->insert(triggers->end(), pending_.triggers.begin() + static_cast<ptrdiff_t>(pending_trigger_),
                     pending_.triggers.begin() + static_cast<ptrdiff_t>(trigger_end));
  }
  pending_trigger_ = trigger_end;
  return has_pending();
}

Result<bool> RecordingReader::accumulate_next(std::span<const TimeSlice> slices, EventImages& images,
                                              std::vector<Trigger>* triggers) {
  bool more = true;
  while (more) {
    E2LF_ASSIGN_OR_RETURN(more, refill_pending(kDefaultBatch));
    if (accumulate_pending(slices, images, triggers)) return true;
  }
  return false;
}

Result<bool> RecordingReader::accumulate(std::span<const TimeSlice> slices, EventImages& images,
                                         std::vector<Trigger>* triggers) {
  E2LF_REQUIRE(images.transitions == slices.size(), "one image for each slice");
  for (size_t i = 0; i < slices.size(); ++i) {
    E2LF_REQUIRE(slices[i].begin_us <= slices[i].end_us, "a slice ends before it begins");
    E2LF_REQUIRE(i == 0 || slices[i - 1].end_us <= slices[i].begin_us, "slices ascend and do not overlap");
  }
  if (slices.empty()) return true;
  E2LF_RETURN_IF_ERROR(find_shift());
  const int64_t shift_us = shift_us_.value_or(0);
  std::vector<TimeSlice> absolute(slices.begin(), slices.end());
  for (TimeSlice& slice : absolute) slice = {slice.begin_us + shift_us, slice.end_us + shift_us};
  const size_t known_triggers = triggers != nullptr ? triggers->size() : 0;

  bool more = accumulate_pending(absolute, images, triggers);
  if (!more) {
    E2LF_ASSIGN_OR_RETURN(more, accumulate_next(absolute, images, triggers));
    E2LF_RETURN_IF_ERROR(apply_policy());
  }
  if (triggers != nullptr && shift_us != 0) {
    for (size_t i = known_triggers; i < triggers->size(); ++i) (*triggers)[i].t -= shift_us;
  }
  return more;
}

Result<void> RecordingReader::seek_before(int64_t) {
  return Error{ErrorCode::kUnsupported, cat("a ", info_.format, " recording cannot be sought; read it from the start"),
               name_};
}

Result<void> RecordingReader::seek(int64_t t_us) {
  E2LF_RETURN_IF_ERROR(find_shift());
  const int64_t absolute_us = t_us + shift_us_.value_or(0);
  summary_ = {};
  known_violations_ = {};
  pending_.clear();
  pending_event_ = pending_trigger_ = 0;
  E2LF_RETURN_IF_ERROR(seek_before(absolute_us));
  bool more = true;
  while (more && !has_pending()) {
    E2LF_ASSIGN_OR_RETURN(more, refill_pending(kDefaultBatch));
    pending_event_ = first_at_or_after(pending_.events.t, 0, absolute_us, time_of_event);
    pending_trigger_ = first_at_or_after(pending_.triggers, 0, absolute_us, time_of_trigger);
  }
  return {};
}

Result<EventBatch> read_all(RecordingReader& reader) {
  EventBatch all;
  EventBatch batch;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, reader.read(batch));
    if (!more) return all;
    all.events.append(batch.events);
    all.triggers.insert(all.triggers.end(), batch.triggers.begin(), batch.triggers.end());
  }
}

}  // namespace e2lf::events
