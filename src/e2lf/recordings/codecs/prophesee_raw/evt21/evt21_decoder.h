// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "e2lf/recordings/codecs/prophesee_raw/timed/layouts.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings::evt21 {

/// EVT2.1 for RawStream; see word_codec.h. check() and decode() are vector versions if the CPU supports them.
template <ByteOrder kOrder>
struct Codec : timed::Words<Layout<kOrder>> {
  using State = timed::State;
  using Check = timed::Check;
  static size_t check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);
  static size_t decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink);
};

/// Returns the byte order in which more of the first words are valid before the first invalid one, or else, in which
/// fewer of them are invalid. Headers are known to omit it or to be wrong. `hint` (the header's "little", "legacy" or
/// nothing) decides if both orders are equal. `words` are the first few kilobytes.
[[nodiscard]] ByteOrder find_byte_order(std::span<const uint8_t> words, const std::string& hint);

}  // namespace e2lf::recordings::evt21
