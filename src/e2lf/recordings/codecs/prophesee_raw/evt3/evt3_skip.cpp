// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_words.h"

namespace e2lf::recordings::evt3 {
namespace {

/// The time that passes between two TIME_HIGH words that differ.
constexpr int64_t kHighStepUs = int64_t{1} << 12;

uint16_t word_at(const uint8_t* words, size_t i) {
  return load_le<uint16_t>(words + 2 * i);
}

/// Takes what later words depend on from words without triggers and steps of TIME_HIGH, and leaves out their events.
void take_context(const uint8_t* words, size_t count, State& state) {
  if (const size_t low = find_last(words, count, only(kTimeLow)); low < count) {
    state.low = static_cast<uint16_t>(word_at(words, low) & kPayloadMask);
  }
  if (const size_t row = find_last(words, count, only(kAddrY)); row < count) {
    state.y = static_cast<uint16_t>(word_at(words, row) & kCoordinateMask);
  }
  const size_t base = find_last(words, count, only(kVectBaseX));
  if (base < count) take_base(word_at(words, base), state);
  const size_t vector = find_last(words, count, kVectors);
  if (vector == count) return;
  for (size_t i = base < count ? base + 1 : 0; i <= vector; ++i) {
    const uint32_t type = word_at(words, i) >> 12;
    if (type == kVect12 || type == kVect8) advance_base(type == kVect12 ? 12 : 8, state);
  }
}

}  // namespace

size_t find_mark_scalar(const uint8_t* words, size_t count, uint16_t time_high) {
  for (size_t i = 0; i < count; ++i) {
    const uint16_t word = word_at(words, i);
    if (word >> 12 == kTrigger || (word >> 12 == kTimeHigh && word != time_high)) return i;
  }
  return count;
}

size_t find_last_scalar(const uint8_t* words, size_t count, TypeSet types) {
  for (size_t i = count; i-- > 0;) {
    if ((word_at(words, i) & types.mask) == types.value) return i;
  }
  return count;
}

size_t Codec::skip_events(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, TimeSpan span,
                          ColumnSink& sink) {
  const auto is_inside = [&] {
    return time(state) - kJitterUs >= span.begin_us && state.high_us + kHighStepUs <= span.end_us;
  };
  size_t i = 0;
  while (i < count && is_inside()) {
    const size_t mark = i + find_mark(words + 2 * i, count - i, state.time_high);
    take_context(words + 2 * i, mark - i, state);
    if (mark == count) return count;
    decode_scalar(words + 2 * mark, 1, state, limits, sink);
    i = mark + 1;
  }
  return i;
}

}  // namespace e2lf::recordings::evt3
