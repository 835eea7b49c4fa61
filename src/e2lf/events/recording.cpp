// SPDX-License-Identifier: MIT
#include "e2lf/events/recording.h"

#include <algorithm>
#include <utility>

#include "e2lf/base/contract.h"
#include "e2lf/base/log.h"
#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/events/count_on.h"

namespace e2lf::events {
namespace {

/// Adds the signed events [begin, end) to an image, saturating; events outside it are left out.
void add_events(const EventColumns& events, size_t begin, size_t end, int16_t* image, size_t width, size_t height) {
  for (size_t i = begin; i < end; ++i) {
    if (events.x[i] >= width || events.y[i] >= height) continue;
    int16_t& count = image[events.y[i] * width + events.x[i]];
    count = static_cast<int16_t>(std::clamp(count + (events.p[i] != 0 ? 1 : -1), -32768, 32767));
  }
}

}  // namespace

std::optional<std::string> RecordingInfo::find(const std::string& key) const {
  for (const auto& [name, value] : header) {
    if (name == key) return value;
  }
  return std::nullopt;
}

Result<bool> RecordingReader::refill_pending(size_t max_events) {
  E2LF_ASSIGN_OR_RETURN(const bool more, read_next(pending_.refill(), max_events));
  E2LF_RETURN_IF_ERROR(apply_policy());
  return more || !pending_.empty();
}

Result<void> RecordingReader::find_shift() {
  if (shift_us_) return {};
  if (options_.time == TimeOrigin::kAbsolute && options_.range == TimeOrigin::kAbsolute) {
    shift_us_ = 0;
    return {};
  }
  bool more = true;
  while (more && pending_.empty()) {
    E2LF_ASSIGN_OR_RETURN(more, refill_pending(kMinBatch));
  }
  if (pending_.empty()) return {};
  const EventBatch& first = pending_.batch();
  const int64_t first_us = first.events.empty()     ? first.triggers.front().t
                           : first.triggers.empty() ? first.events.t.front()
                                                    : std::min(first.events.t.front(), first.triggers.front().t);
  shift_us_ = options_.time == TimeOrigin::kZero ? first_us : 0;
  if (options_.range == TimeOrigin::kZero) range_origin_us_ = first_us;
  return {};
}

Result<void> RecordingReader::apply_policy() {
  if (options_.policy == DecodePolicy::kStrict && summary_.events_before_time > 0) {
    return Error{ErrorCode::kFormat,
                 "events stand in front of the first time, which strict reading refuses; without it they are left out "
                 "and counted",
                 name_};
  }
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

void RecordingReader::count(const EventColumns& events, size_t begin, size_t end) {
  if (begin == end) return;
  if (summary_.events() == 0) summary_.first_t_us = events.t[begin];
  summary_.last_t_us = events.t[end - 1];
  const uint64_t on = count_on({events.p.data() + begin, end - begin});
  summary_.events_on += on;
  summary_.events_off += end - begin - on;
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

/// A time of the options on the sensor's clock.
int64_t RecordingReader::in_range(int64_t t_us) const {
  return std::clamp(t_us, -kTimeLimitUs, kTimeLimitUs) + range_origin_us_;
}

/// Goes to a time where the source can be sought; otherwise passes over what comes before.
Result<void> RecordingReader::begin_at(int64_t absolute_us) {
  const auto sought = seek_before(absolute_us);
  if (!sought && sought.error().code != ErrorCode::kUnsupported) return sought;
  if (sought) pending_.refill();
  return skip_to(absolute_us);
}

Result<void> RecordingReader::skip_to(int64_t absolute_us) {
  for (bool more = true;;) {
    pending_.skip_to(pending_.first_event(absolute_us), pending_.first_trigger(absolute_us));
    if (!pending_.empty() || !more) return {};
    E2LF_ASSIGN_OR_RETURN(more, refill_pending(kDefaultBatch));
  }
}

/// Drops what is at or after a time from a batch; there is no more then.
void RecordingReader::end_at(int64_t absolute_us, EventBatch& batch) {
  const auto is_late = [absolute_us](const auto& t_us) { return t_us >= absolute_us; };
  const auto event = std::find_if(batch.events.t.begin(), batch.events.t.end(), is_late);
  const auto trigger = std::find_if(batch.triggers.begin(), batch.triggers.end(),
                                    [&](const Trigger& candidate) { return is_late(candidate.t); });
  has_ended_ = event != batch.events.t.end() || trigger != batch.triggers.end();
  batch.events.resize(static_cast<size_t>(event - batch.events.t.begin()));
  batch.triggers.erase(trigger, batch.triggers.end());
}

Result<bool> RecordingReader::read(EventBatch& batch, size_t max_events) {
  E2LF_REQUIRE(max_events >= kMinBatch, "a batch holds at least kMinBatch events");
  batch.clear();
  // A live source ends by itself, behind what has arrived.
  if (stop_requested() && !arrival()) return false;
  E2LF_RETURN_IF_ERROR(find_shift());
  if (has_ended_) return false;
  if (!std::exchange(has_begun_, true) && options_.from_us != INT64_MIN) {
    E2LF_RETURN_IF_ERROR(begin_at(in_range(options_.from_us)));
  }
  if (!pending_.empty()) {
    pending_.take(batch, max_events);
  } else {
    bool more = true;
    while (more && batch.empty()) {
      E2LF_ASSIGN_OR_RETURN(more, read_next(batch, max_events));
      E2LF_RETURN_IF_ERROR(apply_policy());
    }
  }
  if (options_.to_us != INT64_MAX) end_at(in_range(options_.to_us), batch);
  count(batch.events, 0, batch.events.size());
  summary_.triggers += batch.triggers.size();
  if (const int64_t shift_us = shift_us_.value_or(0); shift_us != 0) {
    for (int64_t& t : batch.events.t) t -= shift_us;
    for (Trigger& trigger : batch.triggers) trigger.t -= shift_us;
  }
  return !batch.empty();
}

bool RecordingReader::accumulate_pending(std::span<const TimeSlice> slices, EventImages& images,
                                         std::vector<Trigger>* triggers) {
  const EventBatch& batch = pending_.batch();
  const EventColumns& events = batch.events;
  const int64_t end_us = slices.back().end_us;
  size_t slice = 0;
  size_t i = pending_.event();
  while (i < events.size() && events.t[i] < end_us) {
    while (events.t[i] >= slices[slice].end_us) ++slice;
    const bool is_inside = events.t[i] >= slices[slice].begin_us;
    const int64_t until_us = is_inside ? slices[slice].end_us : slices[slice].begin_us;
    const size_t begin = i;
    while (i < events.size() && events.t[i] < until_us) ++i;
    if (is_inside) add_events(events, begin, i, images.image(slice).data(), images.width, images.height);
  }
  const size_t trigger_end = pending_.first_trigger(end_us);
  count(events, pending_.event(), i);
  summary_.triggers += trigger_end - pending_.trigger();
  if (triggers != nullptr) {
    triggers->insert(triggers->end(), batch.triggers.begin() + static_cast<ptrdiff_t>(pending_.trigger()),
                     batch.triggers.begin() + static_cast<ptrdiff_t>(trigger_end));
  }
  pending_.skip_to(i, trigger_end);
  return !pending_.empty();
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
  pending_.refill();
  has_begun_ = true;
  has_ended_ = false;
  E2LF_RETURN_IF_ERROR(seek_before(absolute_us));
  return skip_to(absolute_us);
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
