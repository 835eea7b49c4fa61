// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/recordings/event.h"

namespace e2lf::recordings {

/// Room behind the last event that kernels may overwrite.
inline constexpr size_t kSinkSlack = 64;

/// The size that events must lie in, and whether what the sensor counted itself is summed.
struct SensorLimits {
  uint32_t width = 2048;
  uint32_t height = 2048;
  bool counts_reports = false;
};

/// The times t with begin_us <= t < end_us.
struct TimeSpan {
  int64_t begin_us = 0, end_us = 0;
};

/// Where decoders put events as columns: pointers into EventColumns that have kSinkSlack more elements than they may
/// fill.
///   set_time(t)  the time of what follows. A time before that of the last event (sensors jitter by some microseconds)
///   is
///                raised to it: what is given out is sorted.
///   room()       how many words may be decoded before the sink is full
///   add(x, y, p) one event; add_mask(x, y, p, mask) one event at x + i for each set bit i, all inside the sensor
class ColumnSink {
 public:
  ColumnSink() = default;

  /// Makes room in a batch and fills it behind what it holds, up to so many more events and as many triggers. The
  /// events are to be cut to what was filled in the end.
  ColumnSink(EventBatch& batch, size_t max_events)
      : ColumnSink(batch.events, batch.events.size(), max_events, batch.triggers) {}

  /// The same for columns and triggers apart, from event `begin` on.
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
  size_t max_triggers = 0;  ///< as many more may come
  std::vector<Trigger>* triggers = nullptr;

  /// How many words may be decoded into the room that is left; 0 = full, or nearly so.
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

  /// The time of the last event or trigger given out, in this sink or before it.
  [[nodiscard]] int64_t latest() const { return count > 0 ? std::max(latest_, t[count - 1]) : latest_; }
  void set_latest(int64_t t_us) { latest_ = t_us; }

 private:
  int64_t time_ = INT64_MIN;
  int64_t latest_ = INT64_MIN;
};

}  // namespace e2lf::recordings
