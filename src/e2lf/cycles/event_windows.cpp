// SPDX-License-Identifier: MIT
#include "e2lf/cycles/event_windows.h"

#include <algorithm>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/cycles/marks.h"

namespace e2lf::cycles {

WindowReader::WindowReader(std::unique_ptr<recordings::RecordingReader> reader, WindowOptions options)
    : reader_(std::move(reader)), options_(std::move(options)), begin_us_(options_.origin_us) {
  E2LF_REQUIRE(options_.kind != WindowKind::kTime || options_.duration_us > 0, "a window lasts some time");
  E2LF_REQUIRE(options_.kind != WindowKind::kCount || options_.events > 0, "a window has some events");
}

Result<bool> WindowReader::next(EventWindow& window) {
  window.events.clear();
  if (options_.kind == WindowKind::kTime) return next_by_time(window);
  if (options_.kind == WindowKind::kCount) return next_by_count(window);
  return next_by_triggers(window);
}

/// Reads the next batch once all of this one is taken. Returns false at the end.
Result<bool> WindowReader::read_batch() {
  event_ = trigger_ = 0;
  batch_.clear();
  if (has_ended_) return false;
  E2LF_ASSIGN_OR_RETURN(const bool more, reader_->read(batch_));
  has_ended_ = !more;
  if (more && options_.on_batch) options_.on_batch(batch_);
  return more;
}

/// Moves the events of the batch up to `end` to the window.
Result<void> WindowReader::take(size_t end, EventWindow& window) {
  window.events.append(batch_.events, event_, end);
  event_ = end;
  if (window.events.size() <= options_.max_events) return {};
  return fail(ErrorCode::kInvalidValue, reader_->name(), "a window from ", window.events.t.front(),
              " us on holds more than ", options_.max_events, " events; make windows shorter");
}

/// Rejects a gap of many windows, which indicates damage or a wrong length of the windows.
Result<void> WindowReader::check_gap() const {
  const int64_t next_us = batch_.events.t[event_];
  const int64_t windows = (next_us - *begin_us_) / options_.duration_us;
  if (windows <= options_.max_empty) return {};
  return fail(ErrorCode::kInvalidValue, reader_->name(), "there is no event from ", *begin_us_, " to ", next_us,
              " us, for ", windows, " windows; make windows longer, or choose a part of the recording");
}

Result<bool> WindowReader::next_by_time(EventWindow& window) {
  for (;;) {
    if (!begin_us_ && !batch_.triggers.empty()) begin_us_ = batch_.triggers.front().t;
    if (event_ == 0 && !batch_.events.empty() && !has_begun_) {
      const int64_t first_us = batch_.events.t.front();
      begin_us_ = options_.origin_us.value_or(std::min(begin_us_.value_or(first_us), first_us));
      has_begun_ = true;
    }
    if (event_ < batch_.events.size()) {
      if (window.events.empty()) E2LF_RETURN_IF_ERROR(check_gap());
      const int64_t end_us = *begin_us_ + options_.duration_us;
      E2LF_RETURN_IF_ERROR(take(end_of_run(batch_.events, event_, batch_.events.size(), end_us), window));
      if (event_ < batch_.events.size()) break;
    }
    E2LF_ASSIGN_OR_RETURN(const bool more, read_batch());
    if (more) continue;
    if (window.events.empty() || stop_requested()) return false;
    break;
  }
  window.begin_us = *begin_us_;
  begin_us_ = window.end_us = window.begin_us + options_.duration_us;
  return true;
}

Result<bool> WindowReader::next_by_count(EventWindow& window) {
  while (window.events.size() < options_.events) {
    if (event_ == batch_.events.size()) {
      E2LF_ASSIGN_OR_RETURN(const bool more, read_batch());
      if (!more) break;
    }
    const size_t wanted = options_.events - window.events.size();
    E2LF_RETURN_IF_ERROR(take(std::min(batch_.events.size(), event_ + wanted), window));
  }
  const bool is_whole = window.events.size() == options_.events;
  if (window.events.empty() || (!is_whole && stop_requested())) return false;
  window.begin_us = window.events.t.front();
  window.end_us = window.events.t.back() + 1;
  return true;
}

/// Returns the next trigger of the channel and edge in the batch.
std::optional<int64_t> WindowReader::next_trigger() {
  while (trigger_ < batch_.triggers.size()) {
    const recordings::Trigger& trigger = batch_.triggers[trigger_++];
    if (!is_of(trigger, options_.channel, options_.edge)) continue;
    ++triggers_;
    return trigger.t;
  }
  return std::nullopt;
}

Result<bool> WindowReader::next_by_triggers(EventWindow& window) {
  for (;;) {
    const std::optional<int64_t> trigger_us = next_trigger();
    const size_t all = batch_.events.size();
    const size_t end = !trigger_us ? all : event_ < all ? end_of_run(batch_.events, event_, all, *trigger_us) : all;
    if (begin_us_) {
      E2LF_RETURN_IF_ERROR(take(end, window));
    } else {
      events_outside_ += end - event_;
      event_ = end;
    }
    if (trigger_us) {
      const std::optional<int64_t> begin_us = begin_us_;
      begin_us_ = trigger_us;
      if (!begin_us) continue;
      window.begin_us = *begin_us;
      window.end_us = *trigger_us;
      return true;
    }
    E2LF_ASSIGN_OR_RETURN(const bool more, read_batch());
    if (more) continue;
    events_outside_ += window.events.size();
    return false;
  }
}

namespace {

/// Returns the position of event i among the bins, 0 to bins - 1.
double place_of(const recordings::EventColumns& events, size_t i, size_t bins) {
  const auto last_bin = static_cast<double>(bins - 1);
  const int64_t span_us = events.t.back() - events.t.front();
  if (span_us > 0) return static_cast<double>(events.t[i] - events.t.front()) / static_cast<double>(span_us) * last_bin;
  return events.size() > 1 ? static_cast<double>(i) / static_cast<double>(events.size() - 1) * last_bin : 0.0;
}

}  // namespace

capture::VoxelGrid voxelise(const recordings::EventColumns& events, size_t bins, size_t height, size_t width) {
  E2LF_REQUIRE(bins > 0, "a grid has at least one bin");
  capture::VoxelGrid grid(bins, height, width);
  for (size_t i = 0; i < events.size(); ++i) {
    E2LF_REQUIRE(events.x[i] < width && events.y[i] < height, "an event lies outside of the image");
    const double place = place_of(events, i, bins);
    const size_t bin = std::min(static_cast<size_t>(place), bins - 1);
    const auto share = static_cast<float>(place - static_cast<double>(bin));
    const float sign = events.p[i] != 0 ? 1.0F : -1.0F;
    float* pixel = &grid.values[(bin * height + events.y[i]) * width + events.x[i]];
    *pixel += sign * (1.0F - share);
    if (share > 0.0F) pixel[height * width] += sign * share;
  }
  return grid;
}

std::vector<float> signed_counts(const recordings::EventColumns& events, size_t height, size_t width) {
  return voxelise(events, 1, height, width).values;
}

}  // namespace e2lf::cycles
