// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/base/little_endian.h"

/// EVT2: 32-bit little-endian words with one event each.
namespace e2lf::recordings::evt2 {

struct Layout {
  static constexpr size_t kWordBytes = 4;
  static constexpr size_t kMaxEventsPerWord = 1;
  static uint32_t head(const uint8_t* word) { return load_le<uint32_t>(word); }
  static constexpr uint32_t mask(const uint8_t*) { return 1; }
};

}  // namespace e2lf::recordings::evt2

/// EVT2.1: 64-bit words with a head as in EVT2 and 32 validity bits, where bit i is an event at x + i.
namespace e2lf::recordings::evt21 {

/// The order of the two halves of a word: in little-endian words the head is last, while older sensors send it first
/// ("legacy").
enum class ByteOrder { kLittle, kLegacy };

template <ByteOrder kOrder>
struct Layout {
  static constexpr size_t kWordBytes = 8;
  static constexpr size_t kMaxEventsPerWord = 32;
  static constexpr size_t kHeadOffset = kOrder == ByteOrder::kLittle ? 4 : 0;
  static uint32_t head(const uint8_t* word) { return load_le<uint32_t>(word + kHeadOffset); }
  static uint32_t mask(const uint8_t* word) { return load_le<uint32_t>(word + 4 - kHeadOffset); }
};

}  // namespace e2lf::recordings::evt21
