// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "e2lf/recordings/codecs/prophesee_raw/timed/layouts.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings::evt21 {

/// EVT2.1 for RawStream, see word_codec.h. check() and decode() are the vector versions where the CPU has one.
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

}  // namespace e2lf::recordings::evt21
