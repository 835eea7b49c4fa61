// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_writer.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings::timed {

/// Generates the TIME_HIGH words of EVT2 and EVT2.1: one at every step, and a repetition after 16 us.
class Clock {
 public:
  /// Calls put(head) with the TIME_HIGH heads that must precede an event at `t_us`.
  template <typename Put>
  void advance(int64_t t_us, const Put& put) {
    const int64_t high = t_us >> 6;
    if (high == high_ && t_us - written_us_ < kHeartbeatUs) return;
    int64_t from = high;
    if (high_ < 0) {
      // A recording that begins beyond the 34-bit clock first counts its loops.
      for (int64_t step = kMaxStep; step < high && high > kTimeHighMask; step += kMaxStep) put(head(step));
    } else if (high > high_ && high - high_ <= kMaxFilled) {
      from = high_ + 1;
    } else if (high > high_) {
      for (int64_t step = high_ + kMaxStep; step < high; step += kMaxStep) put(head(step));
    }
    for (int64_t step = from; step <= high; ++step) put(head(step));
    high_ = high;
    written_us_ = t_us;
  }

  /// Later starts would need too many words.
  static constexpr int64_t kMaxFirstUs = int64_t{1} << 52;

 private:
  static constexpr int64_t kHeartbeatUs = 16;
  static constexpr int64_t kMaxStep = int64_t{1} << 25;   ///< a quarter of what would be read as a step back
  static constexpr int64_t kMaxFilled = 10'000'000 / 64;  ///< pauses of up to 10 s are filled step by step

  static uint32_t head(int64_t high) {
    return (static_cast<uint32_t>(kTimeHigh) << 28) | (static_cast<uint32_t>(high) & kTimeHighMask);
  }

  int64_t high_ = -1;
  int64_t written_us_ = 0;
};

inline uint32_t event_head(uint32_t p, int64_t t_us, uint32_t x, uint32_t y) {
  return ((p & 1u) << 28) | (static_cast<uint32_t>(t_us & 0x3F) << 22) | (x << 11) | y;
}

inline uint32_t trigger_head(const Trigger& trigger) {
  return (static_cast<uint32_t>(kTrigger) << 28) | (static_cast<uint32_t>(trigger.t & 0x3F) << 22) |
         (static_cast<uint32_t>(trigger.id & 0x1F) << 8) | (trigger.p & 1u);
}

/// Encodes events and triggers as EVT2 words (the Encoder of RawWriter).
class Evt2Encoder {
 public:
  static constexpr const char* kFormat = "evt2";
  static constexpr int64_t kMaxFirstUs = Clock::kMaxFirstUs, kMaxPauseUs = Clock::kMaxFirstUs;
  static constexpr uint16_t kMaxTriggerId = 31;
  explicit Evt2Encoder(const RecordingInfo&) {}

  void put_events(const EventColumns& events, size_t begin, size_t end, WordBuffer& out) {
    for (size_t i = begin; i < end; ++i) {
      clock_.advance(events.t[i], [&out](uint32_t head) { out.put(head); });
      out.put(event_head(events.p[i], events.t[i], events.x[i], events.y[i]));
    }
  }
  void put_trigger(const Trigger& trigger, WordBuffer& out) {
    clock_.advance(trigger.t, [&out](uint32_t head) { out.put(head); });
    out.put(trigger_head(trigger));
  }

 private:
  Clock clock_;
};

/// Encodes events and triggers as EVT2.1 words (the Encoder of RawWriter): one word for a run of events with the same
/// time, row, polarity and block of 32 pixels. Words are little-endian, or have their halves in "legacy" order if the
/// key `endianness` of the info states so.
class Evt21Encoder {
 public:
  static constexpr const char* kFormat = "evt2.1";
  static constexpr int64_t kMaxFirstUs = Clock::kMaxFirstUs, kMaxPauseUs = Clock::kMaxFirstUs;
  static constexpr uint16_t kMaxTriggerId = 31;
  explicit Evt21Encoder(const RecordingInfo& info) : legacy_(info.find("endianness") == "legacy") {}

  void put_events(const EventColumns& events, size_t begin, size_t end, WordBuffer& out) {
    constexpr uint32_t kBlock = 31;
    for (size_t i = begin; i < end;) {
      const int64_t t = events.t[i];
      const uint32_t base = events.x[i] & ~kBlock;
      clock_.advance(t, [&](uint32_t head) { put(head, 0, out); });
      uint32_t mask = 0;
      size_t last = i;
      do {
        mask |= 1u << (events.x[last] & kBlock);
        ++last;
      } while (last < end && events.t[last] == t && events.y[last] == events.y[i] && events.p[last] == events.p[i] &&
               (events.x[last] & ~kBlock) == base && events.x[last] > events.x[last - 1]);
      put(event_head(events.p[i], t, base, events.y[i]), mask, out);
      i = last;
    }
  }

  void put_trigger(const Trigger& trigger, WordBuffer& out) {
    clock_.advance(trigger.t, [&](uint32_t head) { put(head, 0, out); });
    put(trigger_head(trigger), 0, out);
  }

 private:
  void put(uint32_t head, uint32_t mask, WordBuffer& out) const {
    out.put(legacy_ ? head : mask);
    out.put(legacy_ ? mask : head);
  }

  bool legacy_;
  Clock clock_;
};

}  // namespace e2lf::recordings::timed
