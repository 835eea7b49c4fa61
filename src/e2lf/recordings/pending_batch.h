// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

#include "e2lf/recordings/event.h"

namespace e2lf::recordings {

/// A batch that is returned in pieces, in an order in which everything that was returned is sorted.
class PendingBatch {
 public:
  /// Clears the batch and returns it for filling; memory is kept.
  EventBatch& refill() {
    batch_.clear();
    event_ = trigger_ = 0;
    return batch_;
  }

  [[nodiscard]] bool empty() const { return event_ == batch_.events.size() && trigger_ == batch_.triggers.size(); }
  [[nodiscard]] const EventBatch& batch() const { return batch_; }

  /// Return the index of the first event or trigger that was not returned yet.
  [[nodiscard]] size_t event() const { return event_; }
  [[nodiscard]] size_t trigger() const { return trigger_; }

  /// Skips the events and triggers before these indices.
  void skip_to(size_t event, size_t trigger) {
    event_ = event;
    trigger_ = trigger;
  }

  /// Appends at most `max_events` events and as many triggers to `out`. A complete batch is moved to an empty one
  /// without copying.
  void take(EventBatch& out, size_t max_events) {
    if (out.empty() && event_ == 0 && trigger_ == 0 && batch_.events.size() <= max_events &&
        batch_.triggers.size() <= max_events) {
      std::swap(out, batch_);
      refill();
      return;
    }
    const size_t event_end = std::min(batch_.events.size(), event_ + max_events);
    size_t trigger_end = batch_.triggers.size();
    if (event_end < batch_.events.size()) trigger_end = first_trigger(batch_.events.t[event_end]);
    trigger_end = std::min(trigger_end, trigger_ + max_events);
    out.events.append(batch_.events, event_, event_end);
    out.triggers.insert(out.triggers.end(), batch_.triggers.begin() + static_cast<ptrdiff_t>(trigger_),
                        batch_.triggers.begin() + static_cast<ptrdiff_t>(trigger_end));
    skip_to(event_end, trigger_end);
  }

  /// Return the index of the first remaining event or trigger at or after a time. Times need not be sorted.
  [[nodiscard]] size_t first_event(int64_t t_us) const {
    size_t i = event_;
    while (i < batch_.events.size() && batch_.events.t[i] < t_us) ++i;
    return i;
  }
  [[nodiscard]] size_t first_trigger(int64_t t_us) const {
    size_t i = trigger_;
    while (i < batch_.triggers.size() && batch_.triggers[i].t < t_us) ++i;
    return i;
  }

 private:
  EventBatch batch_;
  size_t event_ = 0;
  size_t trigger_ = 0;
};

}  // namespace e2lf::recordings
