// SPDX-License-Identifier: MIT
#include "e2lf/recordings/batch_check.h"

#include <algorithm>
#include <numeric>

#include "e2lf/base/text.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/recordings/batch_check.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Compilers vectorise these two loops for the instruction set.

/// Returns the largest value, or 0 if there are none.
template <typename T>
uint32_t largest(const T* values, size_t count) {
  T most = 0;
  for (size_t i = 0; i < count; ++i) most = std::max(most, values[i]);
  return most;
}

bool is_sorted(const int64_t* t, size_t count) {
  int64_t falls = 0;
  for (size_t i = 1; i < count; ++i) falls |= t[i] < t[i - 1];
  return falls == 0;
}

/// Returns whether x, y and p are below their bounds and times do not decrease.
bool is_good(const EventColumns& events, uint32_t width, uint32_t height) {
  const size_t count = events.size();
  return largest(events.x.data(), count) < width && largest(events.y.data(), count) < height &&
         largest(events.p.data(), count) <= 1 && is_sorted(events.t.data(), count);
}

/// Returns the sum of bytes that are 0 or 1.
uint64_t sum(const uint8_t* bytes, size_t count) {
  uint64_t total = 0;
  size_t i = 0;
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  const hn::ScalableTag<uint8_t> d;
  const hn::Repartition<uint64_t, decltype(d)> d64;
  const size_t lanes = hn::Lanes(d);
  auto first = hn::Zero(d64), second = hn::Zero(d64);
  for (; i + 2 * lanes <= count; i += 2 * lanes) {
    first = hn::Add(first, hn::SumsOf8(hn::LoadU(d, bytes + i)));
    second = hn::Add(second, hn::SumsOf8(hn::LoadU(d, bytes + i + lanes)));
  }
  total = hn::GetLane(hn::SumOfLanes(d64, hn::Add(first, second)));
#endif
  return std::accumulate(bytes + i, bytes + count, total);
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::recordings {

HWY_EXPORT(is_good);
HWY_EXPORT(sum);

bool is_in_order(const EventColumns& events, size_t width, size_t height) {
  const auto bound = [](size_t side) { return side == 0 ? 65536 : static_cast<uint32_t>(side); };
  return HWY_DYNAMIC_DISPATCH(is_good)(events, bound(width), bound(height));
}

Error BatchCheck::find_error(const EventColumns& events) const {
  const auto place = [&](size_t i) { return cat(name_, ": event ", events_done_ + i); };
  int64_t last_us = last_event_us_;
  for (size_t i = 0; i < events.size(); ++i) {
    const Event event = events[i];
    if ((width_ != 0 && event.x >= width_) || (height_ != 0 && event.y >= height_)) {
      return fail(ErrorCode::kInvalidValue, place(i), "the event at (", event.x, ", ", event.y,
                  ") is outside the sensor of ", width_, "x", height_, "; give the right size");
    }
    if (event.p > 1) return fail(ErrorCode::kInvalidValue, place(i), "polarity ", int{event.p}, " is neither 0 nor 1");
    if (event.t < last_us) {
      return fail(ErrorCode::kInvalidValue, place(i), "time runs back from ", last_us, " to ", event.t,
                  " us; sort the events before writing them");
    }
    last_us = event.t;
  }
  E2LF_REQUIRE(false, "find_error() on a batch without errors");
}

Result<void> BatchCheck::operator()(const EventBatch& batch) {
  const EventColumns& events = batch.events;
  const size_t count = events.size();
  if ((count > 0 && events.t.front() < last_event_us_) || !is_in_order(events, width_, height_)) {
    return find_error(events);
  }
  if (count > 0) last_event_us_ = events.t.back();
  events_done_ += count;

  for (const Trigger& trigger : batch.triggers) {
    if (trigger.t < last_trigger_us_) {
      return fail(ErrorCode::kInvalidValue, name_, "trigger time runs back from ", last_trigger_us_, " to ", trigger.t,
                  " us; sort the triggers before writing them");
    }
    last_trigger_us_ = trigger.t;
  }
  return {};
}

uint64_t count_on(std::span<const uint8_t> p) {
  return HWY_DYNAMIC_DISPATCH(sum)(p.data(), p.size());
}

Result<void> apply_size_option(const OpenOptions& options, RecordingInfo& info, const std::string& name) {
  const auto apply = [&](size_t given, size_t& stated, const char* what) -> Result<void> {
    if (given == 0) return {};
    if (stated != 0 && stated != given) {
      return fail(ErrorCode::kInvalidValue, name, "the file states that its ", what, " is ", stated, ", not ", given,
                  "; leave the option out");
    }
    stated = given;
    return {};
  };
  E2LF_RETURN_IF_ERROR(apply(options.width, info.width, "width"));
  return apply(options.height, info.height, "height");
}

Result<void> refuse_table_options(const OpenOptions& options, const std::string& format, const std::string& name) {
  const bool has_unit = options.time_unit != TimeUnit::kAuto;
  if (!has_unit && options.columns.empty() && options.polarities.empty()) return {};
  return Error{
      ErrorCode::kInvalidValue,
      cat("the format ", format, " defines what its numbers mean; leave columns, time unit and polarities out"), name,
      has_unit ? "time_unit" : "columns"};
}

}  // namespace e2lf::recordings
#endif
