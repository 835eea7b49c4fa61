// SPDX-License-Identifier: MIT
#include "e2lf/events/batch_check.h"

#include "e2lf/base/text.h"

namespace e2lf::events {

Error BatchCheck::find_error(const EventColumns& events) const {
  const auto place = [&](size_t i) { return cat(name_, ": event ", events_done_ + i); };
  int64_t last_us = last_event_us_;
  for (size_t i = 0; i < events.size(); ++i) {
    const Event event = events[i];
    if ((width_ != 0 && event.x >= width_) || (height_ != 0 && event.y >= height_)) {
      return {ErrorCode::kInvalidValue,
              cat("the event at (", event.x, ", ", event.y, ") is outside the sensor of ", width_, "x", height_,
                  "; give the right size"),
              place(i)};
    }
    if (event.p > 1) return {ErrorCode::kInvalidValue, cat("polarity ", int{event.p}, " is neither 0 nor 1"), place(i)};
    if (event.t < last_us) {
      return {ErrorCode::kInvalidValue,
              cat("time runs back from ", last_us, " to ", event.t, " us; sort the events before writing them"),
              place(i)};
    }
    last_us = event.t;
  }
  E2LF_REQUIRE(false, "find_error() on a batch without errors");
}

Result<void> BatchCheck::operator()(const EventBatch& batch) {
  const EventColumns& events = batch.events;
  const uint32_t width = width_ == 0 ? 65536 : static_cast<uint32_t>(width_);
  const uint32_t height = height_ == 0 ? 65536 : static_cast<uint32_t>(height_);
  const size_t count = events.size();
  uint32_t bad = count > 0 && events.t.front() < last_event_us_;
  for (size_t i = 0; i < count; ++i) bad |= (events.x[i] >= width) | (events.y[i] >= height) | (events.p[i] > 1);
  for (size_t i = 1; i < count; ++i) bad |= events.t[i] < events.t[i - 1];
  if (bad != 0) return find_error(events);
  if (count > 0) last_event_us_ = events.t.back();
  events_done_ += count;

  for (const Trigger& trigger : batch.triggers) {
    if (trigger.t < last_trigger_us_) {
      return Error{ErrorCode::kInvalidValue,
                   cat("trigger time runs back from ", last_trigger_us_, " to ", trigger.t,
                       " us; sort the triggers before writing them"),
                   name_};
    }
    last_trigger_us_ = trigger.t;
  }
  return {};
}

Result<void> apply_size_option(const OpenOptions& options, RecordingInfo& info, const std::string& name) {
  const auto apply = [&](size_t given, size_t& stated, const char* what) -> Result<void> {
    if (given == 0) return {};
    if (stated != 0 && stated != given) {
      return Error{ErrorCode::kInvalidValue,
                   cat("the file says its ", what, " is ", stated, ", not ", given, "; leave the option away"), name};
    }
    stated = given;
    return {};
  };
  E2LF_RETURN_IF_ERROR(apply(options.width, info.width, "width"));
  return apply(options.height, info.height, "height");
}

}  // namespace e2lf::events
