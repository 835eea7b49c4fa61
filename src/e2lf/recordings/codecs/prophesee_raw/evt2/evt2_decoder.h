// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

/// EVT2: 32-bit little-endian words, one event each.
namespace e2lf::events::evt2 {

struct Layout {
  static constexpr size_t kWordBytes = 4;
  static constexpr size_t kMaxEventsPerWord = 1;
  static uint32_t head(const uint8_t* word) { return load_le<uint32_t>(word); }
  static constexpr uint32_t mask(const uint8_t*) { return 1; }
};

/// EVT2 for RawStream, see word_checks.h. check() and decode() are the vector versions where the CPU has one.
struct Codec : timed::Words<Layout> {
  static size_t check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);
  static size_t decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink);
};

}  // namespace e2lf::events::evt2
