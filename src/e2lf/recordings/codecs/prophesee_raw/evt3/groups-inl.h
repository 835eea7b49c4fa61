// SPDX-License-Identifier: MIT
// Operations on groups of eight EVT3 words, and the decoder of CPUs that cannot compress 16-bit lanes. Included once
// for each target.
#if defined(E2LF_EVENTS_EVT3_GROUPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_EVT3_GROUPS_INL_H
#undef E2LF_EVENTS_EVT3_GROUPS_INL_H
#else
#define E2LF_EVENTS_EVT3_GROUPS_INL_H
#endif

#include <algorithm>
#include <bit>

#include <hwy/highway.h>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/expand-inl.h"

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

#if HWY_TARGET != HWY_AVX3_DL

using recordings::HWY_NAMESPACE::Columns;
using recordings::HWY_NAMESPACE::expand_mask;

/// Stores four values of `low`, combined with `high`, as 64-bit values.
template <typename D64>
HWY_INLINE void store_four_times(D64 d64, hn::Vec<hn::Full128<uint32_t> > low, int64_t high, int64_t* to) {
  const auto highs = hn::Set(d64, static_cast<uint64_t>(high));
  auto* const out = reinterpret_cast<uint64_t*>(to);
  if constexpr (hn::MaxLanes(D64()) == 4) {
    hn::StoreU(hn::Or(highs, hn::PromoteTo(d64, low)), d64, out);
  } else {
    const hn::Half<hn::Full128<uint32_t> > half;
    hn::StoreU(hn::Or(highs, hn::PromoteTo(d64, hn::LowerHalf(half, low))), d64, out);
    hn::StoreU(hn::Or(highs, hn::PromoteTo(d64, hn::UpperHalf(half, low))), d64, out + 2);
  }
}

HWY_INLINE void store_times(hn::Vec<Group> low, int64_t high, int64_t* to) {
  const hn::Full128<uint32_t> d32;
  const hn::CappedTag<uint64_t, 4> d64;
  const hn::Half<Group> half;
  store_four_times(d64, hn::PromoteTo(d32, hn::LowerHalf(half, low)), high, to);
  store_four_times(d64, hn::PromoteTo(d32, hn::UpperHalf(half, low)), high, to + 4);
}

/// Appends the lanes of a group that are set in `events`; the polarity is bit 11 of the word.
HWY_INLINE void put_events(hn::Vec<Group> word, hn::Vec<Group> x, hn::Vec<Group> y, hn::Vec<Group> low, uint32_t events,
                           int64_t high_us, Columns& out) {
  const Group d;
  const SignedGroup di;
  const hn::Half<GroupBytes> d8;
  const auto chosen = hn::Load(GroupBytes(), kLaneTables.compress[events]);
  const auto polarity = hn::And(hn::ShiftRight<11>(word), hn::Set(d, uint16_t{1}));
  const Columns to = out;
  hn::StoreU(lanes_from(x, chosen), d, to.x + to.count);
  hn::StoreU(lanes_from(y, chosen), d, to.y + to.count);
  hn::StoreU(hn::DemoteTo(d8, hn::BitCast(di, lanes_from(polarity, chosen))), d8, to.p + to.count);
  store_times(lanes_from(low, chosen), high_us, to.t + to.count);
  out.count += static_cast<size_t>(std::popcount(events));
}

/// The state on which words with events depend.
struct Cursor {
  uint32_t low;
  uint32_t y;
  uint32_t base_x;
  uint32_t base_p;
  int64_t high_us;  ///< time without its low bits
};

/// 255 for the types that are not plain. Plain types are single events, the words that determine their place, and
/// ignored words.
HWY_ALIGN constexpr uint8_t kNotPlain[16] = {0, 255, 0, 255, 255, 255, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0};

/// The limits of the words that are decoded.
struct Bounds {
  uint32_t time_high;  ///< the TIME_HIGH word that repeats this time
  uint32_t width;      ///< width of the sensor
};

/// Number of words from a position on that take_vectors() may inspect.
constexpr size_t kVectorWords = 4;

/// Processes the row and time words among `next` (four words, the first in its low bits) before a base, and returns
/// their number; 0 if there is no base, or if another word or an implausible time precedes it.
HWY_INLINE size_t take_places(uint64_t next, const Bounds& bounds, Cursor& cursor) {
  constexpr uint64_t kOnes = 0x0001000100010001;
  // The upper bit of a lane remains zero if its type is a base.
  const uint64_t type_or_none = (next >> 12 & 0xF * kOnes) ^ kVectBaseX * kOnes;
  const uint64_t bases = ~(type_or_none + 0x7FFF * kOnes) & 0x8000 * kOnes;
  if (bases == 0) return 0;
  const auto count = static_cast<size_t>(std::countr_zero(bases)) / 16;
  uint32_t low = cursor.low, y = cursor.y;
  uint32_t bad = 0;
  for (size_t i = 0; i < count; ++i, next >>= 16) {
    const auto word = static_cast<uint32_t>(next & 0xFFFF);
    const uint32_t type = word >> 12;
    const uint32_t new_low = type == kTimeLow ? word & kPayloadMask : low;
    bad |= static_cast<uint32_t>(new_low < low);
    bad |= static_cast<uint32_t>((type != kAddrY) & (type != kTimeLow) & (word != bounds.time_high));
    y = type == kAddrY ? word & kCoordinateMask : y;
    low = new_low;
  }
  if (bad != 0) return 0;
  cursor.low = low;
  cursor.y = y;
  return count;
}

/// Decodes vectors, their bases and the words before these, up to any other word, or a vector that reaches beyond the
/// sensor or has no base. Returns the number of words used.
HWY_INLINE size_t take_vectors(const uint8_t* words, size_t count, const Bounds& bounds, Cursor& cursor, Columns& out) {
  constexpr uint64_t kTripleTypes = 0xF000F000F000, kTriple = 0x500040004000;
  Cursor at = cursor;
  size_t i = 0;
  while (i + kVectorWords <= count) {
    const auto next = load_le<uint64_t>(words + 2 * i);
    const auto type = static_cast<uint32_t>(next >> 12) & 0xF;
    if (type == kVectBaseX) {
      at.base_x = static_cast<uint32_t>(next) & kCoordinateMask;
      at.base_p = static_cast<uint32_t>(next >> 11) & 1;
      ++i;
    } else if ((next & kTripleTypes) == kTriple && at.base_x + 32 <= bounds.width) {
      const uint64_t mask = (next & 0xFFF) | (next >> 4 & 0xFFF000) | (next >> 8 & 0xFF000000);
      expand_mask(static_cast<uint32_t>(mask), at.base_x, at.y, at.base_p, at.high_us | at.low, out);
      at.base_x += 32;
      i += 3;
    } else if (type == kVect8 || type == kVect12) {
      const uint32_t bits = type == kVect8 ? 8 : 12;
      if (at.base_x + bits > bounds.width) break;
      expand_mask(static_cast<uint32_t>(next) & ((1u << bits) - 1), at.base_x, at.y, at.base_p, at.high_us | at.low,
                  out);
      at.base_x += bits;
      ++i;
    } else {
      const size_t places = take_places(next, bounds, at);
      if (places == 0) break;
      i += places;
    }
  }
  cursor = at;
  return i;
}

/// Decodes words up to the first that needs a closer look, contains a time before the last one, or is among the last
/// few. No branch depends on the order of plain words. Returns the number of words used.
HWY_INLINE size_t take_words(const uint8_t* words, size_t count, const Bounds& bounds, Cursor& cursor, Columns& out) {
  const Group d;
  const SignedGroup di;
  const auto not_plain = hn::Load(GroupBytes(), kNotPlain);
  const auto time_high = hn::Set(d, static_cast<uint16_t>(bounds.time_high));
  auto low = hn::Set(d, static_cast<uint16_t>(cursor.low));
  auto y = hn::Set(d, static_cast<uint16_t>(cursor.y));
  size_t i = 0;
  while (i + kGroupWords + kVectorWords <= count) {
    const auto word = hn::LoadU(d, reinterpret_cast<const uint16_t*>(words + 2 * i));
    const auto type = hn::ShiftRight<12>(word);
    const auto equal = [&](hn::Vec<Group> values, hn::Vec<Group> to) { return hn::VecFromMask(d, hn::Eq(values, to)); };
    const auto is = [&](uint32_t value) { return equal(type, hn::Set(d, static_cast<uint16_t>(value))); };
    const auto by_type = hn::BitCast(d, hn::TableLookupBytes(not_plain, hn::BitCast(GroupBytes(), type)));
    const auto stop = hn::ShiftLeft<8>(hn::AndNot(equal(word, time_high), by_type));
    const uint32_t stops_events = bits_of_two(stop, is(kAddrX));
    const uint32_t rows_lows = bits_of_two(is(kAddrY), is(kTimeLow));
    const auto used = static_cast<size_t>(std::countr_zero(stops_events | 0x100));
    const uint32_t taken = (1u << used) - 1;

    const auto lows = fill_forward(hn::And(word, hn::Set(d, uint16_t{kPayloadMask})), rows_lows >> 8 & taken, low);
    const auto before = hn::CombineShiftRightBytes<14>(d, lows, low);
    const auto is_back = hn::Lt(hn::BitCast(di, lows), hn::BitCast(di, before));
    if (!hn::AllFalse(di, is_back)) break;

    const auto x = hn::And(word, hn::Set(d, uint16_t{kCoordinateMask}));
    const auto rows = fill_forward(x, rows_lows & taken, y);
    put_events(word, x, rows, lows, stops_events >> 8 & taken, cursor.high_us, out);
    low = last_in_all(lows);
    y = last_in_all(rows);
    i += kGroupWords;
    if (used < kGroupWords) {
      i -= kGroupWords - used;
      cursor.low = hn::GetLane(low);
      cursor.y = hn::GetLane(y);
      const size_t in_vectors = take_vectors(words + 2 * i, count - i, bounds, cursor, out);
      if (in_vectors == 0) break;
      i += in_vectors;
      low = hn::Set(d, static_cast<uint16_t>(cursor.low));
      y = hn::Set(d, static_cast<uint16_t>(cursor.y));
    }
  }
  cursor.low = hn::GetLane(low);
  cursor.y = hn::GetLane(y);
  return i;
}

/// Decodes groups of words with the kernels above, and the rest with the scalar reference.
size_t decode_columns(const uint8_t* words, size_t count, Evt3State& state, const SensorLimits& limits,
                      ColumnSink& sink) {
  sink.set_time(Evt3WordCodec::time(state));
  for (size_t i = 0; i < count;) {
    // The kernels use times as they are, so they cannot run while the time is raised to that of an earlier event.
    if (sink.time() == Evt3WordCodec::time(state)) {
      const Bounds bounds{state.time_high, limits.width};
      Cursor cursor{state.low, state.y, state.base_x, state.base_p, state.high_us};
      Columns out{sink.x, sink.y, sink.p, sink.t, sink.count};
      i += take_words(words + 2 * i, count - i, bounds, cursor, out);
      sink.count = out.count;
      state.low = static_cast<uint16_t>(cursor.low);
      state.y = static_cast<uint16_t>(cursor.y);
      state.base_x = static_cast<uint16_t>(cursor.base_x);
      state.base_p = static_cast<uint8_t>(cursor.base_p);
    }
    const size_t left = std::min(count - i, kGroupWords);
    i += Evt3WordCodec::decode_scalar(words + 2 * i, left, state, limits, sink);
    sink.set_time(Evt3WordCodec::time(state));
  }
  return count;
}

#endif

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings::evt3
HWY_AFTER_NAMESPACE();

#endif
