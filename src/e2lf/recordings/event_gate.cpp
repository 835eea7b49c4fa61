// SPDX-License-Identifier: MIT
#include "e2lf/recordings/event_gate.h"

#include <algorithm>
#include <utility>

namespace e2lf::recordings {
void EventGate::release(EventColumns& events) {
  num_released_ = waiting_.size();
  events.append(waiting_);
  waiting_.clear();
}

void EventGate::reset() {
  last_us_ = -kTimeLimitUs;
  waiting_.clear();
}

bool EventGate::all_believable(const EventColumns& events, size_t begin) const {
  const uint32_t width = width_ == 0 ? 65536 : static_cast<uint32_t>(width_);
  const uint32_t height = height_ == 0 ? 65536 : static_cast<uint32_t>(height_);
  uint32_t outside = 0;
  for (size_t i = begin; i < events.size(); ++i) outside |= (events.x[i] >= width) | (events.y[i] >= height);
  uint32_t backwards = begin < events.size() && events.t[begin] < last_us_;
  for (size_t i = begin + 1; i < events.size(); ++i) backwards |= events.t[i] < events.t[i - 1];
  const bool in_time = begin == events.size() || is_time(events.t.back());
  return (outside | backwards) == 0 && in_time;
}

/// Moves the plausible events of [begin, end) to the front and returns their end.
size_t EventGate::remove_unbelievable(EventColumns& events, size_t begin, size_t end, uint64_t byte,
                                      DecodeSummary& summary) {
  const auto time_at = [&](size_t i) { return events.t[i]; };
  size_t kept = begin;
  for (size_t i = begin; i < end; ++i) {
    const bool outside = (width_ != 0 && events.x[i] >= width_) || (height_ != 0 && events.y[i] >= height_);
    const bool backwards = events.t[i] < last_us_;
    const uint64_t place = byte + (i - begin) * record_bytes_;
    if (outside || backwards || !is_time(events.t[i]) || is_ahead_of_successors(i, events.size(), last_us_, time_at)) {
      const Violation kind = outside     ? Violation::kOutOfRange
                             : backwards ? Violation::kTimeBackwards
                                         : Violation::kTimeJump;
      summary.add_dropped(kind, place);
      continue;
    }
    last_us_ = events.t[i];
    events.set(kept++, events[i]);
  }
  return kept;
}

void EventGate::filter(EventColumns& events, size_t begin, bool is_end, uint64_t byte, DecodeSummary& summary) {
  const size_t wait = is_end ? 0 : std::min(kTimeLookAhead, events.size() - begin);
  const size_t judged = events.size() - wait;
  size_t kept = judged;
  byte -= std::exchange(num_released_, 0) * record_bytes_;
  if (!all_believable(events, begin)) {
    kept = remove_unbelievable(events, begin, judged, byte, summary);
  } else if (judged > begin) {
    last_us_ = events.t[judged - 1];
  }
  waiting_.clear();
  waiting_.append(events, judged, events.size());
  events.resize(kept);
}

}  // namespace e2lf::recordings
