// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_writer.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings::timed {

inline constexpr int64_t kMaxStep = int64_t{1} << 25;   ///< a quarter of what would be read as a step back
inline constexpr int64_t kMaxFilled = 10'000'000 / 64;  ///< pauses of up to 10 s are filled step by step

/// Later starts and longer pauses would need too many words.
inline constexpr int64_t kLongestUs = int64_t{1} << 52;

using Clock = HighTimes<6, kTimeHighMask, kMaxStep, kMaxFilled>;

inline uint32_t time_head(uint32_t high) {
  return (static_cast<uint32_t>(kTimeHigh) << 28) | high;
}

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
  static constexpr int64_t kMaxFirstUs = kLongestUs, kMaxPauseUs = kLongestUs;
  static constexpr uint16_t kMaxTriggerId = 31;
  explicit Evt2Encoder(const RecordingInfo&) {}

  void put_events(const EventColumns& events, size_t begin, size_t end, std::vector<uint8_t>& out) {
    for (size_t i = begin; i < end; ++i) {
      put(event_head(events.p[i], events.t[i], events.x[i], events.y[i]), events.t[i], out);
    }
  }
  void put_trigger(const Trigger& trigger, std::vector<uint8_t>& out) { put(trigger_head(trigger), trigger.t, out); }

 private:
  void put(uint32_t head, int64_t t_us, std::vector<uint8_t>& out) {
    clock_.advance(t_us, [&out](uint32_t high) { put_word(out, time_head(high)); });
    put_word(out, head);
  }

  Clock clock_;
};

/// Encodes events and triggers as EVT2.1 words (the Encoder of RawWriter): one word for a run of events with the same
/// time, row, polarity and block of 32 pixels. Words are little-endian, or have their halves in "legacy" order if the
/// key `endianness` of the info states so.
class Evt21Encoder {
 public:
  static constexpr const char* kFormat = "evt2.1";
  static constexpr int64_t kMaxFirstUs = kLongestUs, kMaxPauseUs = kLongestUs;
  static constexpr uint16_t kMaxTriggerId = 31;
  explicit Evt21Encoder(const RecordingInfo& info) : legacy_(info.find("endianness") == "legacy") {}

  void put_events(const EventColumns& events, size_t begin, size_t end, std::vector<uint8_t>& out) {
    constexpr uint32_t kBlock = 31;
    for (size_t i = begin; i < end;) {
      const int64_t t = events.t[i];
      const uint32_t base = events.x[i] & ~kBlock;
      uint32_t mask = 0;
      size_t last = i;
      do {
        mask |= 1u << (events.x[last] & kBlock);
        ++last;
      } while (last < end && events.t[last] == t && events.y[last] == events.y[i] && events.p[last] == events.p[i] &&
               (events.x[last] & ~kBlock) == base && events.x[last] > events.x[last - 1]);
      put(event_head(events.p[i], t, base, events.y[i]), mask, t, out);
      i = last;
    }
  }

  void put_trigger(const Trigger& trigger, std::vector<uint8_t>& out) { put(trigger_head(trigger), 0, trigger.t, out); }

 private:
  void put(uint32_t head, uint32_t mask, int64_t t_us, std::vector<uint8_t>& out) {
    clock_.advance(t_us, [&](uint32_t high) { put_halves(time_head(high), 0, out); });
    put_halves(head, mask, out);
  }
  void put_halves(uint32_t head, uint32_t mask, std::vector<uint8_t>& out) const {
    put_word(out, legacy_ ? head : mask);
    put_word(out, legacy_ ? mask : head);
  }

  bool legacy_;
  Clock clock_;
};

}  // namespace e2lf::recordings::timed
