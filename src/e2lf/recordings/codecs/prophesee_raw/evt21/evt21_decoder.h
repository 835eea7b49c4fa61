// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

/// EVT2.1: 64-bit words of a head (as in EVT2) and 32 validity bits, bit i = an event at x + i.
namespace e2lf::events::evt21 {

/// The order of the two halves: plain little-endian words have the head last, older sensors send it first ("legacy").
enum class ByteOrder { kLittle, kLegacy };

template <ByteOrder kOrder>
struct Layout {
  static constexpr size_t kWordBytes = 8;
  static constexpr size_t kMaxEventsPerWord = 32;
  static constexpr size_t kHeadOffset = kOrder == ByteOrder::kLittle ? 4 : 0;
  static uint32_t head(const uint8_t* word) { return load_le<uint32_t>(word + kHeadOffset); }
  static uint32_t mask(const uint8_t* word) { return load_le<uint32_t>(word + 4 - kHeadOffset); }
};

/// EVT2.1 for RawStream, see word_checks.h. check() and decode() are the vector versions where the CPU has one.
template <ByteOrder kOrder>
struct Codec : timed::Words<Layout<kOrder>> {
  using State = timed::State;
  using Check = timed::Check;
  static size_t check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);
  static size_t decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink);
};

/// The byte order in which the first words make sense for longer, or where that is the same, in which fewer of them
/// make none; headers are known to be silent about it, or wrong. `hint` (the header's "little", "legacy" or nothing)
/// decides when both do. `words`: the first few kilobytes.
[[nodiscard]] ByteOrder find_byte_order(std::span<const uint8_t> words, const std::string& hint);

}  // namespace e2lf::events::evt21
