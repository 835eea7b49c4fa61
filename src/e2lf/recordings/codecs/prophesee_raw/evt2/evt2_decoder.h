// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/recordings/codecs/prophesee_raw/timed/layouts.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings::evt2 {

/// EVT2 for RawStream; see word_codec.h. check() and decode() are vector versions if the CPU supports them.
struct Codec : timed::Words<Layout> {
  static size_t check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);
  static size_t decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink);
};

}  // namespace e2lf::recordings::evt2
