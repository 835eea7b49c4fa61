// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/evt2/evt2_decoder.h"

#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_kernels.h"

namespace e2lf::recordings::evt2 {

size_t Codec::check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  return timed::kernels(timed::Encoding::kEvt2).check(words, count, check, limits);
}

size_t Codec::decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
  return timed::kernels(timed::Encoding::kEvt2).decode(words, count, state, limits, sink);
}

}  // namespace e2lf::recordings::evt2
