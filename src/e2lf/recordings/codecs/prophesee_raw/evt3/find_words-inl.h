// SPDX-License-Identifier: MIT
// The search for EVT3 words of some types. Included once for each target.
#if defined(E2LF_EVENTS_EVT3_FIND_WORDS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_EVT3_FIND_WORDS_INL_H
#undef E2LF_EVENTS_EVT3_FIND_WORDS_INL_H
#else
#define E2LF_EVENTS_EVT3_FIND_WORDS_INL_H
#endif

#include <hwy/highway.h>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_words.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings::evt3 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128

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

#endif
