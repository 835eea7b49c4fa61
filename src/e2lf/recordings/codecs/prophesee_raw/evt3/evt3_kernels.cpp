// SPDX-License-Identifier: MIT
// Implements the vector kernels of evt3_decoder.h.
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_words.h"

#define HWY_WANT_AVX3_DL 1
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/check-inl.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/groups-inl.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/plain_words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings::evt3 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128

size_t check_words(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  return check_scalar(words, count, check, limits);
}
size_t decode_columns(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
  return Codec::decode_scalar(words, count, state, limits, sink);
}
size_t find_mark_in(const uint8_t* words, size_t count, uint16_t time_high) {
  return find_mark_scalar(words, count, time_high);
}
size_t find_last_in(const uint8_t* words, size_t count, TypeSet types) {
  return find_last_scalar(words, count, types);
}

#else

size_t find_mark_in(const uint8_t* words, size_t count, uint16_t time_high) {
  const hn::ScalableTag<uint16_t> d;
  const size_t lanes = hn::Lanes(d);
  const auto known = hn::Set(d, time_high);
  const auto time = hn::Set(d, static_cast<uint16_t>(kTimeHigh)), trigger = hn::Set(d, static_cast<uint16_t>(kTrigger));
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto word = hn::LoadU(d, reinterpret_cast<const uint16_t*>(words + 2 * i));
    const auto type = hn::ShiftRight<12>(word);
    const auto steps = hn::AndNot(hn::Eq(word, known), hn::Eq(type, time));
    const auto marks = hn::Or(steps, hn::Eq(type, trigger));
    if (!hn::AllFalse(d, marks)) return i + hn::FindKnownFirstTrue(d, marks);
  }
  return i + find_mark_scalar(words + 2 * i, count - i, time_high);
}

size_t find_last_in(const uint8_t* words, size_t count, TypeSet types) {
  const hn::ScalableTag<uint16_t> d;
  const size_t lanes = hn::Lanes(d);
  const auto mask = hn::Set(d, types.mask), value = hn::Set(d, types.value);
  size_t end = count;
  for (; end >= lanes; end -= lanes) {
    const auto word = hn::LoadU(d, reinterpret_cast<const uint16_t*>(words + 2 * (end - lanes)));
    const auto found = hn::Eq(hn::And(word, mask), value);
    if (!hn::AllFalse(d, found)) break;
  }
  const size_t last = find_last_scalar(words, end, types);
  return last < end ? last : count;
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings::evt3
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::recordings::evt3 {

HWY_EXPORT(check_words);
HWY_EXPORT(decode_columns);
HWY_EXPORT(find_mark_in);
HWY_EXPORT(find_last_in);

size_t find_mark(const uint8_t* words, size_t count, uint16_t time_high) {
  return HWY_DYNAMIC_DISPATCH(find_mark_in)(words, count, time_high);
}

size_t find_last(const uint8_t* words, size_t count, TypeSet types) {
  return HWY_DYNAMIC_DISPATCH(find_last_in)(words, count, types);
}

size_t Codec::check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  return HWY_DYNAMIC_DISPATCH(check_words)(words, count, check, limits);
}

size_t Codec::decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
  return HWY_DYNAMIC_DISPATCH(decode_columns)(words, count, state, limits, sink);
}

}  // namespace e2lf::recordings::evt3
#endif
