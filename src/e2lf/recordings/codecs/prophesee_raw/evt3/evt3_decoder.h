// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_writer.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/word_codec.h"
#include "e2lf/recordings/io/decode_summary.h"

/// EVT3: 16-bit little-endian words, the type in bits 15..12.
namespace e2lf::recordings::evt3 {

enum Type : uint32_t {
  kAddrY = 0x0,        ///< y in bits 10..0, for the words that follow
  kAddrX = 0x2,        ///< one event: x in bits 10..0, polarity in bit 11
  kVectBaseX = 0x3,    ///< x and polarity of the vectors that follow
  kVect12 = 0x4,       ///< 12 validity bits: bit i is an event at base + i; then base += 12
  kVect8 = 0x5,        ///< the same with 8 bits
  kTimeLow = 0x6,      ///< t in bits 11..0
  kContinued4 = 0x7,   ///< payload of kOthers
  kTimeHigh = 0x8,     ///< t bits 23..12
  kTrigger = 0xA,      ///< edge in bit 0, input in bits 11..8
  kOthers = 0xE,       ///< monitoring data: ignored
  kContinued12 = 0xF,  ///< payload of kOthers
};

/// Some cameras pad their packets with this word.
inline constexpr uint16_t kPadding = 0x9999;

/// The OTHERS words that begin a count by the sensor: of the events that it generated, and of those that it sent. The
/// count follows in CONTINUED words, lowest bits first: 12, 12 and 4 bits.
inline constexpr uint16_t kCountIn = 0xE014;
inline constexpr uint16_t kCountSent = 0xE016;

/// The OTHERS word at the end of a MIPI frame. Frames of fixed size are filled up with zero words.
inline constexpr uint16_t kFrameEnd = 0xE019;

/// Bit k is set if type k exists.
inline constexpr uint32_t kKnownTypes = (1u << kAddrY) | (1u << kAddrX) | (1u << kVectBaseX) | (1u << kVect12) |
                                        (1u << kVect8) | (1u << kTimeLow) | (1u << kContinued4) | (1u << kTimeHigh) |
                                        (1u << kTrigger) | (1u << kOthers) | (1u << kContinued12);

inline constexpr uint32_t kCoordinateMask = 0x7FF;
inline constexpr uint32_t kPayloadMask = 0xFFF;
inline constexpr uint32_t kMinFall = 2;  ///< smallest backward step of TIME_HIGH that may be a restart of the clock
inline constexpr uint32_t kHalfCircle = 2048;  ///< a step of TIME_HIGH by this much or more is a step back
inline constexpr int64_t kLoopUs = int64_t{1} << 24;

/// Tolerated decrease of times: those of real sensors decrease by some microseconds.
inline constexpr int kJitterUs = 64;

/// Words w with (w & mask) == value, which selects one type or two neighbouring ones.
struct TypeSet {
  uint16_t mask, value;
};
inline constexpr TypeSet only(Type type) {
  return {0xF000, static_cast<uint16_t>(type << 12)};
}
inline constexpr TypeSet kVectors = {0xE000, kVect12 << 12};  ///< kVect12 and kVect8

/// Returns the index of the first trigger, or of the first TIME_HIGH word that differs from `time_high`; `count` if
/// there is none.
[[nodiscard]] size_t find_mark(const uint8_t* words, size_t count, uint16_t time_high);

/// Returns the index of the last word of some types, or `count` if there is none.
[[nodiscard]] size_t find_last(const uint8_t* words, size_t count, TypeSet types);

/// The scalar references of the two functions above.
[[nodiscard]] size_t find_mark_scalar(const uint8_t* words, size_t count, uint16_t time_high);
[[nodiscard]] size_t find_last_scalar(const uint8_t* words, size_t count, TypeSet types);

/// Shuffle tables for every set of eight 16-bit lanes (a byte): the byte positions from which a shuffle takes its
/// lanes; 0x80 = none.
struct LaneTables {
  alignas(16) uint8_t fill[256][16];      ///< lane i is the last lane of the set up to i
  alignas(16) uint8_t compress[256][16];  ///< lane k is the k-th lane of the set
};

inline constexpr LaneTables kLaneTables = [] {
  LaneTables tables{};
  const auto put = [](uint8_t* row, size_t lane, int from) {
    row[2 * lane] = static_cast<uint8_t>(from < 0 ? 0x80 : 2 * from);
    row[2 * lane + 1] = static_cast<uint8_t>(from < 0 ? 0x80 : 2 * from + 1);
  };
  for (size_t set = 0; set < 256; ++set) {
    int last = -1;
    size_t count = 0;
    for (size_t lane = 0; lane < 8; ++lane) {
      if (((set >> lane) & 1) != 0) {
        last = static_cast<int>(lane);
        put(tables.compress[set], count++, last);
      }
      put(tables.fill[set], lane, last);
    }
    for (; count < 8; ++count) put(tables.compress[set], count, -1);
  }
  return tables;
}();

/// The state on which the meaning of words depends.
struct Evt3State {
  int64_t high_us = 0;          ///< time without its low 12 bits, including loops of the 24-bit clock
  uint16_t time_high = 0xFFFF;  ///< the last TIME_HIGH word; 0xFFFF = none yet, events are dropped
  uint16_t low = 0;             ///< the last TIME_LOW payload
  uint16_t y = 0;
  uint16_t base_x = 0xFFFF;  ///< x of the next vector; 0xFFFF = none yet, vectors are dropped
  uint8_t base_p = 0;
  uint64_t num_outside = 0;    ///< events of vectors that were dropped: outside the sensor, or without a base
  bool need_time_high = true;  ///< events are dropped until such a word has arrived
  bool need_low = false;
  bool need_y = false;
  uint16_t report = 0;      ///< the OTHERS word whose payload may follow; 0 = none
  uint8_t report_bits = 0;  ///< number of payload bits so far
  bool operator==(const Evt3State&) const = default;
};

/// The state of the check of words, which runs ahead of decoding.
struct Check {
  uint16_t time_high = 0xFFFF;  ///< as in Evt3State
  int32_t low = -1;             ///< the last TIME_LOW payload, -1 = unknown
  uint32_t num_rejected = 0;    ///< number of consecutive unexpected TIME_HIGH words
  int64_t heartbeat = -4;  ///< number of repeated TIME_HIGH words minus three for each step; 0 or more is a heartbeat
  bool after_damage = false;  ///< the next TIME_HIGH may be noise
  uint32_t num_zeros = 0;     ///< number of preceding words that are zero
  bool after_frame = false;   ///< the frame has ended, so that zeros may fill it up
  bool operator==(const Check&) const = default;
};

/// A forward step within one TIME_HIGH beyond which the following words are inspected.
inline constexpr int kLongStepUs = 128;

/// Returns whether one TIME_LOW may follow another within the same TIME_HIGH; `last` is -1 if it is unknown.
inline bool is_plausible_low(int last, int next) {
  return last < 0 || (next + kJitterUs >= last && next <= last + kLongStepUs);
}

/// EVT3 for RawStream; word_codec.h describes the functions.
struct Evt3WordCodec {
  using State = Evt3State;
  using Check = evt3::Check;
  static constexpr size_t kWordBytes = 2;
  static constexpr size_t kMaxEventsPerWord = 12;
  static constexpr CoarseClock kClock{kPayloadMask, 12, kMinFall, kJudges, /*believes_next=*/true};

  static std::optional<uint32_t> coarse_time(const uint8_t* word);
  static std::optional<uint32_t> coarse_time(const Check& check);
  static size_t check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);
  static size_t count_bad(const uint8_t* words, size_t count, size_t enough);
  static Violation classify(const uint8_t* word, const Check& check, const SensorLimits& limits);
  static Verdict judge_time(const uint8_t* words, size_t count, bool ended, const Check& check);
  static void accept_time(const uint8_t* word, Check& check);
  static size_t num_padding(const uint8_t* words, size_t count, const Check& check);
  static void forget(State& state, Check& check);
  static void drop_word(const uint8_t* word, State& state);
  static void take_needed(const uint8_t* word, State& state);
  static bool has_time(const State& state) { return state.time_high != 0xFFFF; }
  static void count_reports(const uint8_t* words, size_t count, State& state, DecodeSummary& summary);
  static bool is_synchronised(const State& state) { return !state.need_time_high && !state.need_low && !state.need_y; }
  static void extrapolate(State& state, const State& before);
  static int64_t time(const State& state) { return state.high_us | state.low; }
  static uint64_t time_loops(const State& state) { return static_cast<uint64_t>(state.high_us / kLoopUs); }

  /// Skips the words up to the first one that may belong to a time outside the span, and returns their triggers, but
  /// not their events. Returns the number of words used, which is 0 outside the span.
  static size_t skip_events(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, TimeSpan span,
                            ColumnSink& sink);

  /// The vector version if the CPU supports it, otherwise decode_scalar(), which decodes checked words one by one and
  /// returns `count`. Events of vectors outside the sensor are dropped.
  static size_t decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink);
  static size_t decode_scalar(const uint8_t* words, size_t count, State& state, const SensorLimits& limits,
                              ColumnSink& sink);
};

/// The scalar reference of Evt3WordCodec::check().
size_t check_scalar(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);

/// Encodes events and triggers as EVT3 words (the Encoder of RawWriter). Runs of events in one row with the same
/// polarity become vectors (always a base and 12, 12 and 8 pixels, which every reader supports) if this is shorter.
/// TIME_HIGH is written at every step, and repeated after 16 us.
class Encoder {
 public:
  static constexpr const char* kFormat = "evt3";
  explicit Encoder(const RecordingInfo& info) : width_(static_cast<uint32_t>(info.width)) {}

  /// Later starts would need too many words that only count the loops of the 24-bit clock.
  static constexpr int64_t kMaxFirstUs = int64_t{1} << 41;

  /// Pauses are filled with time words, 2 bytes per 4 ms: 32 MiB for the longest, 19 hours.
  static constexpr int64_t kMaxPauseUs = int64_t{1} << 36;
  static constexpr uint16_t kMaxTriggerId = 15;

  void put_events(const EventColumns& events, size_t begin, size_t end, std::vector<uint8_t>& out);
  void put_trigger(const Trigger& trigger, std::vector<uint8_t>& out);

 private:
  void put_time(int64_t t_us, std::vector<uint8_t>& out);
  void put_row(const EventColumns& events, size_t begin, size_t end, std::vector<uint8_t>& out);

  static constexpr int64_t kMaxStep = 512;  ///< of TIME_HIGH when loops are counted: a quarter of a step back
  uint32_t width_;
  HighTimes<12, kPayloadMask, kMaxStep> clock_;
  int64_t t_us_ = -1;  ///< the time after the words so far
  uint32_t y_ = 0xFFFF;
};

}  // namespace e2lf::recordings::evt3
