// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/recordings/event.h"

namespace e2lf::recordings {

/// Number of elements after the last event that kernels may overwrite.
inline constexpr size_t kSinkSlack = 64;

/// The size of the sensor, and whether the sensor's own counts are summed.
struct SensorLimits {
  uint32_t width = 2048;
  uint32_t height = 2048;
  bool counts_reports = false;
};

/// The times t with begin_us <= t < end_us.
struct TimeSpan {
  int64_t begin_us = 0, end_us = 0;
};

/// The destination of decoders: pointers to columns of EventColumns, which have kSinkSlack more elements than may be
/// filled.
///   set_time(t)  sets the time of what follows. A time before that of the last event (sensors jitter by some us) is
///                raised to it, so that the output is sorted.
///   room()       returns how many words may be decoded before the sink is full
///   add(x, y, p) adds an event; add_mask(x, y, p, mask) adds an event at x + i for each set bit i, all in the sensor
class ColumnSink {
 public:
  ColumnSink() = default;

  /// Reserves room in a batch and appends to it, at most `max_events` events and as many triggers. Afterwards, the
  /// events must be resized to what was filled.
  ColumnSink(EventBatch& batch, size_t max_events)
      : ColumnSink(batch.events, batch.events.size(), max_events, batch.triggers) {}

  /// Does the same for separate columns and triggers, from event `begin` on.
  ColumnSink(EventColumns& events, size_t begin, size_t max_events, std::vector<Trigger>& to_triggers)
      : capacity(max_events), max_triggers(to_triggers.size() + max_events), triggers(&to_triggers) {
    events.resize(begin + max_events + kSinkSlack);
    x = events.x.data() + begin;
    y = events.y.data() + begin;
    p = events.p.data() + begin;
    t = events.t.data() + begin;
  }

  uint16_t* x = nullptr;
  uint16_t* y = nullptr;
  uint8_t* p = nullptr;
  int64_t* t = nullptr;
  size_t count = 0;
  size_t capacity = 0;      ///< in events; the columns have kSinkSlack more elements
  size_t max_triggers = 0;  ///< largest number of triggers
  std::vector<Trigger>* triggers = nullptr;

  /// Returns the number of words that may be decoded to the remaining room; 0 = full, or nearly so.
  [[nodiscard]] size_t room(size_t max_events_per_word) const {
    const size_t trigger_room = max_triggers - std::min(max_triggers, triggers->size());
    const size_t words = std::min((capacity - count) / max_events_per_word, trigger_room);
    constexpr size_t kTooFew = 32;
    return count > 0 && words < kTooFew ? 0 : words;
  }

  void set_time(int64_t t_us) { time_ = std::max(latest(), t_us); }
  [[nodiscard]] int64_t time() const { return time_; }

  void add(uint32_t event_x, uint32_t event_y, uint32_t event_p) {
    x[count] = static_cast<uint16_t>(event_x);
    y[count] = static_cast<uint16_t>(event_y);
    p[count] = static_cast<uint8_t>(event_p);
    t[count] = time_;
    ++count;
  }
  void add_mask(uint32_t base_x, uint32_t event_y, uint32_t event_p, uint32_t mask) {
    for (; mask != 0; mask &= mask - 1) add(base_x + static_cast<uint32_t>(std::countr_zero(mask)), event_y, event_p);
  }
  void add_trigger(uint32_t id, uint32_t edge) {
    triggers->push_back({time_, static_cast<uint16_t>(id), static_cast<uint8_t>(edge)});
    latest_ = time_;
  }

  /// Returns the time of the last event or trigger, in this sink or before it.
  [[nodiscard]] int64_t latest() const { return count > 0 ? std::max(latest_, t[count - 1]) : latest_; }
  void set_latest(int64_t t_us) { latest_ = t_us; }

 private:
  int64_t time_ = INT64_MIN;
  int64_t latest_ = INT64_MIN;
};

}  // namespace e2lf::recordings
