// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

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

}  // namespace e2lf::recordings::evt3
