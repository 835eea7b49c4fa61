// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

namespace e2lf::recordings::timed {

enum class Encoding { kEvt2, kEvt21Little, kEvt21Legacy };

/// The vector versions of Words<Layout>::check_scalar() and decode_scalar() for one encoding.
struct Kernels {
  size_t (*check)(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits);
  size_t (*decode)(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink);
};

/// Returns those for this CPU, or the scalar references if it has no vector unit.
[[nodiscard]] Kernels kernels(Encoding encoding);

}  // namespace e2lf::recordings::timed
