// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings::timed {

enum class Encoding { kEvt2, kEvt21Little, kEvt21Legacy };

/// EVT2: 32-bit little-endian words with one event each.
struct Evt2Layout {
  static constexpr Encoding kEncoding = Encoding::kEvt2;
  static constexpr size_t kWordBytes = 4;
  static constexpr size_t kMaxEventsPerWord = 1;
  static uint32_t head(const uint8_t* word) { return load_le<uint32_t>(word); }
  static constexpr uint32_t mask(const uint8_t*) { return 1; }
};

/// The order of the two halves of an EVT2.1 word: in little-endian words the head is last, while older sensors send it
/// first ("legacy").
enum class ByteOrder { kLittle, kLegacy };

/// EVT2.1: 64-bit words with a head as in EVT2 and 32 validity bits, where bit i is an event at x + i.
template <ByteOrder kOrder>
struct Evt21Layout {
  static constexpr Encoding kEncoding = kOrder == ByteOrder::kLittle ? Encoding::kEvt21Little : Encoding::kEvt21Legacy;
  static constexpr size_t kWordBytes = 8;
  static constexpr size_t kMaxEventsPerWord = 32;
  static constexpr size_t kHeadOffset = kOrder == ByteOrder::kLittle ? 4 : 0;
  static uint32_t head(const uint8_t* word) { return load_le<uint32_t>(word + kHeadOffset); }
  static uint32_t mask(const uint8_t* word) { return load_le<uint32_t>(word + 4 - kHeadOffset); }
};

/// The vector versions of Words<Layout>::check_scalar() and decode_scalar() for one encoding.
struct Kernels {
  size_t (*check)(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);
  size_t (*decode)(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink);
};

/// Returns those for this CPU, or the scalar references if it has no vector unit.
[[nodiscard]] Kernels kernels(Encoding encoding);

/// EVT2 or EVT2.1 for RawStream; see word_codec.h.
template <typename Layout>
struct Codec : Words<Layout> {
  static size_t check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
    return kernels(Layout::kEncoding).check(words, count, check, limits);
  }
  static size_t decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
    return kernels(Layout::kEncoding).decode(words, count, state, limits, sink);
  }
};

/// Returns the byte order of EVT2.1 in which more of the first words are valid before the first invalid one, or else,
/// in which fewer of them are invalid. Headers are known to omit it or to be wrong. `hint` (the header's "little",
/// "legacy" or nothing) decides if both orders are equal. `words` are the first few kilobytes.
[[nodiscard]] ByteOrder find_byte_order(std::span<const uint8_t> words, const std::string& hint);

}  // namespace e2lf::recordings::timed
