// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/events/event.h"
#include "e2lf/events/recording.h"

namespace e2lf::events {

/// Room behind the last event that kernels may overwrite.
inline constexpr size_t kSinkSlack = 64;

/// The size that events must lie in.
struct SensorLimits {
  uint32_t width = 2048;
  uint32_t height = 2048;
};

/// Where decoders put events as columns: pointers into EventColumns that have kSinkSlack more elements than they may
/// fill. Both sinks have the same functions; decoders are templates over them.
///   set_time(t)  the time of what follows; false = the sink takes no event of that time: stop before the first one. A
///   time before that of the
///                last event (sensors jitter by some microseconds) is raised to it: what is given out is sorted.
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

  bool set_time(int64_t t_us) {
    time_ = std::max(latest(), t_us);
    return true;
  }
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

/// Where decoders add signed events to one image per time slice.
class ImageSink {
 public:
  ImageSink(std::span<const TimeSlice> slices, EventImages& images, std::vector<Trigger>* triggers)
      : slices_(slices), images_(&images), triggers_(triggers) {}

  [[nodiscard]] static size_t room(size_t) { return SIZE_MAX; }

  bool set_time(int64_t t_us) {
    settle();
    t_us = std::max(latest_, t_us);
    if (t_us >= begin_ && t_us < end_) {
      time_ = t_us;
      is_open_ = true;
    } else {
      is_open_ = select(t_us);
    }
    return is_open_;
  }
  /// What set_time() returned last.
  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] int64_t time() const { return time_; }

  void add(uint32_t x, uint32_t y, uint32_t p) {
    ++(p != 0 ? on : off);
    if (image_ != nullptr && x < images_->width && y < images_->height) {
      bump(image_[y * images_->width + x], p != 0 ? 1 : -1);
    }
  }
  void add_mask(uint32_t base_x, uint32_t y, uint32_t p, uint32_t mask) {
    for (; mask != 0; mask &= mask - 1) add(base_x + static_cast<uint32_t>(std::countr_zero(mask)), y, p);
  }
  /// Adds `count` events of the current slice (image() is not null) that are sorted by time and inside the image.
  void add_block(const uint16_t* x, const uint16_t* y, const uint8_t* p, const int64_t* t, size_t count) {
    if (count == 0) return;
    // Images are larger than caches near the core: the pixels of the next events are fetched while some are counted.
    constexpr size_t kAhead = 32;
    const auto prefetch = [&](size_t begin) {
      for (size_t i = begin; i < std::min(begin + kAhead, count); ++i) prefetch_pixel(x[i], y[i]);
    };
    uint64_t count_on = 0;
    prefetch(0);
    for (size_t begin = 0; begin < count; begin += kAhead) {
      prefetch(begin + kAhead);
      for (size_t i = begin; i < std::min(begin + kAhead, count); ++i) {
        bump(image_[y[i] * images_->width + x[i]], 2 * p[i] - 1);
        count_on += p[i];
      }
    }
    note_events(count_on, count - count_on, t[0], t[count - 1]);
  }
  /// Has a pixel of image() brought near; it may lie outside.
  void prefetch_pixel(size_t x, size_t y) const {
    const auto place = reinterpret_cast<uintptr_t>(image_) + sizeof(int16_t) * (y * images_->width + x);
    __builtin_prefetch(reinterpret_cast<const void*>(place), 1);
  }
  /// Counts events that were added to image() without this sink.
  void note_events(uint64_t count_on, uint64_t count_off, int64_t first_us, int64_t last_us) {
    settle();
    if (settled_ == 0) first_t_us = first_us;
    on += count_on;
    off += count_off;
    settled_ = on + off;
    time_ = last_t_us = latest_ = std::max(latest_, last_us);
  }

  void add_trigger(uint32_t id, uint32_t edge) {
    ++num_triggers;
    latest_ = time_;
    if (triggers_ != nullptr) {
      triggers_->push_back({time_, static_cast<uint16_t>(id), static_cast<uint8_t>(edge)});
    }
  }

  /// The image that events at the current time go to, null between slices; row-major, width() wide.
  [[nodiscard]] int16_t* image() const { return image_; }
  [[nodiscard]] int64_t slice_end_us() const { return end_; }
  [[nodiscard]] size_t width() const { return images_->width; }
  [[nodiscard]] size_t height() const { return images_->height; }

  /// Adds 1 or -1 to one count, stopping at the ends of int16.
  static void bump(int16_t& count, int step) {
    int16_t sum = 0;
    // A branch that is hardly ever taken is less work than limiting every sum.
    if (!__builtin_add_overflow(count, step, &sum)) count = sum;
  }

  /// Takes over what has been counted so far: sets first_t_us and last_t_us.
  void settle() {
    const uint64_t events = on + off;
    if (events == settled_) return;
    if (settled_ == 0) first_t_us = time_;
    last_t_us = latest_ = time_;
    settled_ = events;
  }

  [[nodiscard]] int64_t latest() {
    settle();
    return latest_;
  }
  void set_latest(int64_t t_us) { latest_ = t_us; }

  /// Takes over what another sink has counted behind this one, but for its images; times before latest() are raised.
  void append(ImageSink& later) {
    const int64_t before_us = latest();
    later.settle();
    if (later.settled_ > 0) {
      if (settled_ == 0) first_t_us = std::max(before_us, later.first_t_us);
      last_t_us = std::max(before_us, later.last_t_us);
    }
    on += later.on;
    off += later.off;
    settled_ = on + off;
    num_triggers += later.num_triggers;
    latest_ = std::max(before_us, later.latest_);
    if (triggers_ == nullptr || later.triggers_ == nullptr) return;
    for (const Trigger& trigger : *later.triggers_) {
      triggers_->push_back({std::max(before_us, trigger.t), trigger.id, trigger.p});
    }
  }

  /// No image from this one on has been counted into.
  [[nodiscard]] size_t images_end() const { return images_end_; }

  uint64_t on = 0;
  uint64_t off = 0;
  uint64_t num_triggers = 0;
  int64_t first_t_us = 0;
  int64_t last_t_us = 0;

 private:
  bool select(int64_t t_us) {
    if (t_us >= slices_.back().end_us) return false;
    const auto slice = std::upper_bound(slices_.begin(), slices_.end(), t_us,
                                        [](int64_t value, const TimeSlice& range) { return value < range.end_us; });
    time_ = t_us;
    const bool inside = t_us >= slice->begin_us;
    begin_ = inside ? slice->begin_us : t_us;
    end_ = inside ? slice->end_us : t_us;
    const auto index = static_cast<size_t>(slice - slices_.begin());
    image_ = inside ? images_->image(index).data() : nullptr;
    if (inside) images_end_ = index + 1;
    return true;
  }

  std::span<const TimeSlice> slices_;
  EventImages* images_;
  std::vector<Trigger>* triggers_;
  int16_t* image_ = nullptr;
  int64_t begin_ = 0;  // the times for which image_ holds; empty between slices
  int64_t end_ = 0;
  int64_t time_ = INT64_MIN;
  bool is_open_ = false;
  int64_t latest_ = INT64_MIN;  ///< of the last event or trigger given out
  uint64_t settled_ = 0;
  size_t images_end_ = 0;
};

}  // namespace e2lf::events
