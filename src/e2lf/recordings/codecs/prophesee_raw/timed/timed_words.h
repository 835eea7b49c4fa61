// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_writer.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/word_codec.h"
#include "e2lf/recordings/io/decode_summary.h"

/// EVT2 and EVT2.1: every event brings the low 6 bits of its time. The 32-bit head of a word has the type in bits
/// 31..28; EVT2.1 adds 32 validity bits.
namespace e2lf::recordings::timed {

/// EVT2: 32-bit little-endian words with one event each. EVT2.1: 64-bit words with a head as in EVT2 and 32 validity
/// bits, where bit i is an event at x + i. In little-endian words the head is last, while older sensors send it first
/// ("legacy").
enum class Encoding { kEvt2, kEvt21Little, kEvt21Legacy };

enum Type : uint32_t {
  kOff = 0x0,       ///< event(s): t bits 5..0 in 27..22, x in 21..11, y in 10..0
  kOn = 0x1,        ///< the same for ON events
  kTimeHigh = 0x8,  ///< t bits 33..6 in 27..0
  kTrigger = 0xA,   ///< t bits 5..0 in 27..22, input in 12..8, edge in 0
  kOthers = 0xE,    ///< monitoring data: ignored
  kContinued = 0xF,
};

inline constexpr uint32_t kKnownTypes =
    (1u << kOff) | (1u << kOn) | (1u << kTimeHigh) | (1u << kTrigger) | (1u << kOthers) | (1u << kContinued);
inline constexpr uint32_t kTimeHighMask = 0xFFFFFFF;
inline constexpr uint32_t kHalfCircle = 1u << 27;
inline constexpr uint32_t kBackOne = kTimeHighMask;     ///< one step back on the 28-bit circle, which is jitter
inline constexpr uint32_t kNearSteps = 64;              ///< 4 ms
inline constexpr uint32_t kMinFall = kDisorderUs >> 6;  ///< of a restart of the clock
inline constexpr int kLoopBits = 34;
inline constexpr uint32_t kNoTime = 0xFFFFFFFF;

inline uint32_t type_of(uint32_t head) {
  return head >> 28;
}
inline uint32_t low_of(uint32_t head) {
  return (head >> 22) & 0x3F;
}
inline uint32_t x_of(uint32_t head) {
  return (head >> 11) & 0x7FF;
}
inline uint32_t y_of(uint32_t head) {
  return head & 0x7FF;
}

/// Returns the number of steps from `from` to `to` on the 28-bit circle.
inline uint32_t steps(uint32_t from, uint32_t to) {
  return (to - from) & kTimeHighMask;
}

struct TimedState {
  int64_t high_us = 0;           ///< time without its low 6 bits, including loops
  uint32_t time_high = kNoTime;  ///< the payload of the last TIME_HIGH word
  uint64_t num_outside = 0;      ///< events of vectors that were dropped because they are outside the sensor
  bool need_time_high = true;    ///< events are dropped until such a word has arrived
  bool operator==(const TimedState&) const = default;
};

struct Check {
  uint32_t time_high = kNoTime;
  uint32_t num_rejected = 0;
  int64_t heartbeat = -16;    ///< number of repeated TIME_HIGH words minus those that step; 0 or more is a heartbeat
  bool after_damage = false;  ///< the next TIME_HIGH may be noise
  uint32_t num_zeros = 0;     ///< number of preceding words that are zero
  bool operator==(const Check&) const = default;
};

/// Updates the time of the state with a TIME_HIGH word. Backward steps beyond jitter do not occur here.
inline void take_time_high(uint32_t time_high, TimedState& state) {
  if (state.time_high == kNoTime) {
    state.high_us = static_cast<int64_t>(time_high) << 6;
  } else {
    const uint32_t step = steps(state.time_high, time_high);
    state.high_us += step == kBackOne ? -64 : int64_t{step < kHalfCircle ? step : 1} << 6;
  }
  state.time_high = time_high;
}

/// The functions of a WordCodec (word_codec.h) except check() and decode(), for which it contains scalar references.
template <Encoding kEncoding>
struct Words {
  using State = TimedState;
  using Check = timed::Check;
  static constexpr size_t kWordBytes = kEncoding == Encoding::kEvt2 ? 4 : 8;
  static constexpr size_t kMaxEventsPerWord = kEncoding == Encoding::kEvt2 ? 1 : 32;
  static constexpr size_t kHeadOffset = kEncoding == Encoding::kEvt21Little ? 4 : 0;

  static constexpr CoarseClock kClock{kTimeHighMask, 6, kMinFall, kNearSteps, /*believes_next=*/false};

  static uint32_t head_of(const uint8_t* word) { return load_le<uint32_t>(word + kHeadOffset); }
  static uint32_t mask_of(const uint8_t* word) {
    return kEncoding == Encoding::kEvt2 ? 1 : load_le<uint32_t>(word + 4 - kHeadOffset);
  }
  static std::optional<uint32_t> coarse_time(const uint8_t* word) {
    const uint32_t head = head_of(word);
    return type_of(head) == kTimeHigh ? std::optional(head & kTimeHighMask) : std::nullopt;
  }
  static std::optional<uint32_t> coarse_time(const Check& check) {
    return check.time_high == kNoTime ? std::nullopt : std::optional(check.time_high);
  }
  static bool is_known(uint32_t head) { return ((kKnownTypes >> type_of(head)) & 1) != 0; }
  static bool is_outside(uint32_t head, const SensorLimits& limits) {
    return type_of(head) <= kOn && (x_of(head) >= limits.width || y_of(head) >= limits.height);
  }
  static bool is_zero(const uint8_t* word) { return head_of(word) == 0 && mask_of(word) <= 1; }

  /// Returns whether a word is plausible given the state of the check, which is then updated. A run of zeros is not
  /// data.
  static bool check_word(const uint8_t* word, Check& check, const SensorLimits& limits) {
    const uint32_t head = head_of(word);
    check.num_zeros = is_zero(word) ? check.num_zeros + 1 : 0;
    if (check.num_zeros > kMaxZeros) return false;
    if (type_of(head) != kTimeHigh) return is_known(head) && !is_outside(head, limits);
    if (check.time_high == kNoTime) return false;
    const uint32_t step = steps(check.time_high, head);
    if (step > 1 && step != kBackOne) return false;
    check.heartbeat += step == 0 ? 1 : -1;
    check.num_rejected = 0;
    check.time_high = head & kTimeHighMask;
    return true;
  }

  static size_t check_scalar(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
    size_t i = 0;
    while (i < count && check_word(words + i * kWordBytes, check, limits)) ++i;
    return i;
  }

  static size_t count_bad(const uint8_t* words, size_t count, size_t enough) {
    size_t bad = 0;
    uint32_t time_high = kNoTime;
    uint32_t num_zeros = 0;
    for (size_t i = 0; i < count && bad < enough; ++i) {
      const uint8_t* word = words + i * kWordBytes;
      const uint32_t head = head_of(word);
      num_zeros = is_zero(word) ? num_zeros + 1 : 0;
      bool odd = !is_known(head) || num_zeros > kMaxZeros;
      if (type_of(head) == kTimeHigh) {
        const uint32_t step = time_high == kNoTime ? 0 : steps(time_high, head);
        odd = step >= kHalfCircle && step != kBackOne;
        time_high = head & kTimeHighMask;
      } else if (kMaxEventsPerWord > 1 && type_of(head) <= kOn) {
        // Vectors begin at multiples of 32 and are not empty.
        odd = odd || x_of(head) % 32 != 0 || mask_of(word) == 0;
      } else if (type_of(head) == kTrigger) {
        odd = (head & 0x3FE0FE) != 0;
      }
      bad += odd ? 1 : 0;
    }
    return bad;
  }

  static Violation classify(const uint8_t* word, const Check& check, const SensorLimits& limits) {
    const uint32_t head = head_of(word);
    if (!is_known(head) || is_zero(word)) return Violation::kUnknownWord;
    if (is_outside(head, limits)) return Violation::kOutOfRange;
    const bool is_back = check.time_high != kNoTime && steps(check.time_high, head) >= kHalfCircle;
    return is_back ? Violation::kTimeBackwards : Violation::kTimeJump;
  }

  static Verdict judge_time(const uint8_t* words, size_t count, bool ended, const Check& check) {
    return judge_coarse_time<Words>(words, count, ended, check);
  }

  static void accept_time(const uint8_t* word, Check& check) {
    check.time_high = head_of(word) & kTimeHighMask;
    check.num_rejected = 0;
    check.num_zeros = 0;
    check.after_damage = false;
    --check.heartbeat;
  }

  /// These encodings have a separate type for padding.
  static size_t num_padding(const uint8_t*, size_t, const Check&) { return 0; }

  static void forget(State& state, Check& check) {
    state.need_time_high = true;
    check.num_zeros = 0;
    check.after_damage = true;
  }
  static void drop_word(const uint8_t* word, State& state) {
    if (type_of(head_of(word)) == kTimeHigh) state.need_time_high = true;
  }

  static void take_needed(const uint8_t* word, State& state) {
    if (type_of(head_of(word)) == kTimeHigh) state.need_time_high = false;
  }
  static bool has_time(const State& state) { return state.time_high != kNoTime; }
  static bool is_synchronised(const State& state) { return !state.need_time_high; }

  static void extrapolate(State& state, const State& before) {
    // Up to 15/16 of a loop ahead, or 18 minutes back.
    constexpr uint32_t kBack = 1u << 24;
    const uint32_t ahead = (state.time_high - before.time_high + kBack) & kTimeHighMask;
    state.high_us = before.high_us + ((int64_t{ahead} - kBack) << 6);
  }
  static int64_t time(const State& state) { return state.high_us; }
  static uint64_t time_loops(const State& state) { return static_cast<uint64_t>(state.high_us >> kLoopBits); }

  /// Returns the part of a vector's mask that is inside the sensor.
  static uint32_t inside(const uint8_t* word, const SensorLimits& limits) {
    const uint32_t x = x_of(head_of(word)), mask = mask_of(word);
    return x + 32 <= limits.width ? mask : mask & ((1u << (limits.width - x)) - 1);
  }

  static size_t decode_scalar(const uint8_t* words, size_t count, State& state, const SensorLimits& limits,
                              ColumnSink& sink) {
    for (size_t i = 0; i < count; ++i) {
      const uint8_t* word = words + i * kWordBytes;
      const uint32_t head = head_of(word);
      switch (type_of(head)) {
        case kOff:
        case kOn:
          if constexpr (kMaxEventsPerWord == 1) {
            sink.set_time(state.high_us | low_of(head));
            sink.add(x_of(head), y_of(head), type_of(head));
          } else {
            const uint32_t mask = inside(word, limits);
            if (mask != 0) sink.set_time(state.high_us | low_of(head));
            state.num_outside += static_cast<uint64_t>(std::popcount(mask_of(word) ^ mask));
            sink.add_mask(x_of(head), y_of(head), type_of(head), mask);
          }
          break;
        case kTimeHigh:
          take_time_high(head & kTimeHighMask, state);
          break;
        case kTrigger:
          sink.set_time(state.high_us | low_of(head));
          sink.add_trigger((head >> 8) & 0x1F, head & 1);
          break;
        default:
          break;
      }
    }
    return count;
  }
};

/// The vector versions of Words::check_scalar() and decode_scalar() for one encoding.
struct Kernels {
  size_t (*check)(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);
  size_t (*decode)(const uint8_t* words, size_t count, TimedState& state, const SensorLimits& limits, ColumnSink& sink);
};

/// Returns those for this CPU, or the scalar references if it has no vector unit.
[[nodiscard]] Kernels kernels(Encoding encoding);

/// EVT2 or EVT2.1 for RawStream; see word_codec.h.
template <Encoding kEncoding>
struct TimedWordCodec : Words<kEncoding> {
  static size_t check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
    return kernels(kEncoding).check(words, count, check, limits);
  }
  static size_t decode(const uint8_t* words, size_t count, TimedState& state, const SensorLimits& limits,
                       ColumnSink& sink) {
    return kernels(kEncoding).decode(words, count, state, limits, sink);
  }
};

/// Returns the byte order of EVT2.1 in which more of the first words are valid before the first invalid one, or else,
/// in which fewer of them are invalid. Headers are known to omit it or to be wrong. `hint` (the header's "little",
/// "legacy" or nothing) decides if both orders are equal. `words` are the first few kilobytes.
[[nodiscard]] Encoding find_byte_order(std::span<const uint8_t> words, const std::string& hint);

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
