// SPDX-License-Identifier: MIT
// Operations on groups of eight lanes of EVT3 words. Included once for each target.
#if defined(E2LF_EVENTS_EVT3_LANE_GROUPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_EVT3_LANE_GROUPS_INL_H
#undef E2LF_EVENTS_EVT3_LANE_GROUPS_INL_H
#else
#define E2LF_EVENTS_EVT3_LANE_GROUPS_INL_H
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_words.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings::evt3 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128

using Group = hn::Full128<uint16_t>;
using GroupBytes = hn::Full128<uint8_t>;
using SignedGroup = hn::Full128<int16_t>;
constexpr size_t kGroupWords = 8;

HWY_INLINE hn::Vec<Group> lanes_from(hn::Vec<Group> values, hn::Vec<GroupBytes> bytes) {
  return hn::BitCast(Group(), hn::TableLookupBytesOr0(hn::BitCast(GroupBytes(), values), bytes));
}

/// Returns for each lane the value of the last lane of the set up to it, or `before` if there is none.
HWY_INLINE hn::Vec<Group> fill_forward(hn::Vec<Group> values, uint32_t set, hn::Vec<Group> before) {
  const hn::Full128<int8_t> di8;
  const auto from = hn::Load(GroupBytes(), kLaneTables.fill[set]);
  // Positions that do not exist are negative.
  return hn::BitCast(Group(), hn::IfNegativeThenElse(hn::BitCast(di8, from), hn::BitCast(di8, before),
                                                     hn::BitCast(di8, lanes_from(values, from))));
}

/// Returns the last lane in all lanes.
HWY_INLINE hn::Vec<Group> last_in_all(hn::Vec<Group> values) {
  return lanes_from(values, hn::BitCast(GroupBytes(), hn::Set(Group(), uint16_t{0x0F0E})));
}

/// Returns the difference of each lane and the one before it; before the first is the last lane of `before`.
HWY_INLINE hn::Vec<SignedGroup> steps_of(hn::Vec<Group> values, hn::Vec<Group> before) {
  const auto previous = hn::CombineShiftRightBytes<14>(Group(), values, before);
  return hn::BitCast(SignedGroup(), hn::Sub(values, previous));
}

/// Returns which lanes of `first` (bits 0 to 7) and of `second` (bits 8 to 15) are set. All bits of the upper byte of a
/// lane are equal; the lower byte is equal to it or 0.
HWY_INLINE uint32_t bits_of_two(hn::Vec<Group> first, hn::Vec<Group> second) {
#if HWY_ARCH_X86
  return static_cast<uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(first.raw, second.raw)));
#else
  const GroupBytes d8;
  const auto bytes = hn::ConcatOdd(d8, hn::BitCast(d8, second), hn::BitCast(d8, first));
  uint16_t bits = 0;
  hn::StoreMaskBits(d8, hn::MaskFromVec(bytes), reinterpret_cast<uint8_t*>(&bits));
  return bits;
#endif
}

#if HWY_TARGET == HWY_AVX3_DL

/// Returns the lanes shifted up by one, with `first` in lane 0.
HWY_INLINE __m512i move_up(__m512i values, int first) {
  const __m512i from =
      _mm512_setr_epi32(0x0000001F, 0x20001, 0x40003, 0x60005, 0x80007, 0xA0009, 0xC000B, 0xE000D, 0x10000F, 0x120011,
                        0x140013, 0x160015, 0x180017, 0x1A0019, 0x1C001B, 0x1E001D);
  return _mm512_mask_mov_epi16(_mm512_permutexvar_epi16(from, values), 1,
                               _mm512_set1_epi16(static_cast<int16_t>(first)));
}

#endif

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings::evt3
HWY_AFTER_NAMESPACE();

#endif
