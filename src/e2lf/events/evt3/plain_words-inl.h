// SPDX-License-Identifier: MIT
// Runs of EVT3 words that are events, their rows and times, and what is ignored. Included once for each target.
#if defined(E2LF_EVENTS_EVT3_PLAIN_WORDS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_EVT3_PLAIN_WORDS_INL_H
#undef E2LF_EVENTS_EVT3_PLAIN_WORDS_INL_H
#else
#define E2LF_EVENTS_EVT3_PLAIN_WORDS_INL_H
#endif

#include <algorithm>
#include <array>
#include <bit>

#include <hwy/highway.h>

#include "e2lf/events/evt3/evt3_decoder.h"
#include "e2lf/events/evt3/lane_groups-inl.h"
#include "e2lf/events/raw/expand-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::events::evt3 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128

using events::HWY_NAMESPACE::Columns;

/// What plain words change: events and everything that leaves the loops out of them.
struct Cursor {
  int64_t high;        ///< time without its low bits
  int64_t end_us;      ///< words that bring this time or a later one are not taken
  uint32_t time_high;  ///< the TIME_HIGH word that repeats this time
  uint32_t low;
  uint32_t y;
};

/// Types that are plain: events, what places them, and what is ignored. Others need a closer look.
constexpr uint32_t kPlainTypes =
    (1u << kAddrY) | (1u << kAddrX) | (1u << kTimeLow) | (1u << kContinued4) | (1u << kOthers) | (1u << kContinued12);

/// Decodes plain words up to the first that is not, or that moves time back or to the end. No branch depends on the
/// order in which the types come. Returns how many words were used.
size_t take_plain_words(const uint8_t* words, size_t count, Cursor& cursor, Columns& out) {
  struct Effect {
    int64_t low_mask;
    uint32_t y_mask;
    uint32_t is_event;
  };
  static constexpr auto kEffects = [] {
    std::array<Effect, 16> effects{};
    effects[kTimeLow].low_mask = kPayloadMask;
    effects[kAddrY].y_mask = kCoordinateMask;
    effects[kAddrX].is_event = 1;
    return effects;
  }();
  // Copies, because stores through a byte pointer could change anything that is not local.
  const Columns to = out;
  const Cursor from = cursor;
  size_t num_events = to.count;
  int64_t low = cursor.low;
  const int64_t last_low = std::min<int64_t>(cursor.end_us - cursor.high, 4096) - 1;
  uint32_t y = cursor.y;
  size_t i = 0;
  for (; i < count; ++i) {
    const uint32_t word = load_le<uint16_t>(words + 2 * i);
    const uint32_t type = word >> 12;
    const Effect effect = kEffects[type];
    const int64_t next_low = (low & ~effect.low_mask) | (word & effect.low_mask);
    // Signs in place of comparisons, of which the compiler would make branches that nothing can predict.
    const auto out_of_time = static_cast<uint64_t>((next_low - low) | (last_low - next_low)) >> 63;
    const uint32_t is_heartbeat = ((word ^ from.time_high) - 1) >> 31;
    if ((((kPlainTypes >> type) & 1 & ~static_cast<uint32_t>(out_of_time)) | is_heartbeat) == 0) break;
    to.x[num_events] = static_cast<uint16_t>(word & kCoordinateMask);
    to.y[num_events] = static_cast<uint16_t>(y);
    to.p[num_events] = static_cast<uint8_t>((word >> 11) & 1);
    to.t[num_events] = from.high | low;
    num_events += effect.is_event;
    y = (y & ~effect.y_mask) | (word & effect.y_mask);
    low = next_low;
  }
  out.count = num_events;
  cursor.low = static_cast<uint32_t>(low);
  cursor.y = y;
  return i;
}

#if HWY_TARGET == HWY_AVX3_DL

/// How many lanes up to each lane, itself included, are set in `bits`.
HWY_INLINE __m512i count_up_to_lane(uint32_t bits) {
  const __m512i all = _mm512_set1_epi32(static_cast<int>(bits));
  const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m512i up_to = _mm512_sub_epi32(_mm512_sllv_epi32(_mm512_set1_epi32(2), lane), _mm512_set1_epi32(1));
  const __m512i up_to_high = _mm512_or_si512(_mm512_slli_epi32(up_to, 16), _mm512_set1_epi32(0xFFFF));
  const __m512i first = _mm512_popcnt_epi32(_mm512_and_si512(all, up_to));
  const __m512i second = _mm512_popcnt_epi32(_mm512_and_si512(all, up_to_high));
  return _mm512_inserti64x4(_mm512_castsi256_si512(_mm512_cvtepi32_epi16(first)), _mm512_cvtepi32_epi16(second), 1);
}

/// For each lane `values` of the last lane set in `bits`, itself included; `before` for lanes in front of the first.
HWY_INLINE __m512i fill_forward(__m512i values, uint32_t bits, uint32_t before) {
  const __m512i index = _mm512_sub_epi16(count_up_to_lane(bits), _mm512_set1_epi16(1));
  const __m512i filled = _mm512_permutexvar_epi16(index, _mm512_maskz_compress_epi16(bits, values));
  const uint32_t in_front = bits != 0 ? (bits & (0 - bits)) - 1 : 0xFFFFFFFF;
  return _mm512_mask_mov_epi16(filled, in_front, _mm512_set1_epi16(static_cast<int16_t>(before)));
}

/// take_plain_words() for 32 words at a time, while 32 are left; events of a group are compressed to the front.
size_t take_plain_groups(const uint8_t* words, size_t count, Cursor& cursor, Columns& out) {
  const __m512i coordinate_mask = _mm512_set1_epi16(kCoordinateMask);
  size_t i = 0;
  while (i + 32 <= count) {
    const __m512i word = _mm512_loadu_si512(words + 2 * i);
    const __m512i type = _mm512_srli_epi16(word, 12);
    const __m512i type_bit = _mm512_sllv_epi16(_mm512_set1_epi16(1), type);
    uint32_t plain = _mm512_test_epi16_mask(type_bit, _mm512_set1_epi16(static_cast<int16_t>(kPlainTypes)));
    plain |= _mm512_cmpeq_epi16_mask(word, _mm512_set1_epi16(static_cast<int16_t>(cursor.time_high)));
    const auto used = static_cast<uint32_t>(std::countr_one(plain));
    if (used == 0) break;
    const uint32_t taken = used == 32 ? 0xFFFFFFFF : (1u << used) - 1;
    const uint32_t events = _mm512_mask_cmpeq_epi16_mask(taken, type, _mm512_set1_epi16(kAddrX));
    const uint32_t rows = _mm512_mask_cmpeq_epi16_mask(taken, type, _mm512_set1_epi16(kAddrY));
    const uint32_t lows = _mm512_mask_cmpeq_epi16_mask(taken, type, _mm512_set1_epi16(kTimeLow));
    const __m512i place = _mm512_and_si512(word, coordinate_mask);

    __m512i low = _mm512_set1_epi16(static_cast<int16_t>(cursor.low));
    uint32_t last_low = cursor.low;
    if (lows != 0) {
      low = fill_forward(_mm512_and_si512(word, _mm512_set1_epi16(kPayloadMask)), lows, cursor.low);
      const __m512i before = move_up(low, static_cast<int>(cursor.low));
      last_low = load_le<uint16_t>(words + 2 * (i + 31 - static_cast<size_t>(std::countl_zero(lows)))) & kPayloadMask;
      const bool back = _mm512_mask_cmplt_epu16_mask(taken, low, before) != 0;
      if (back || (cursor.high | static_cast<int64_t>(last_low)) >= cursor.end_us) break;
    }
    if (events != 0) {
      const __m512i y = fill_forward(place, rows, cursor.y);
      const auto num_events = static_cast<size_t>(std::popcount(events));
      const size_t at = out.count;
      _mm512_storeu_si512(out.x + at, _mm512_maskz_compress_epi16(events, place));
      _mm512_storeu_si512(out.y + at, _mm512_maskz_compress_epi16(events, y));
      const __m512i polarity = _mm512_and_si512(_mm512_srli_epi16(word, 11), _mm512_set1_epi16(1));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(out.p + at),
                          _mm512_cvtepi16_epi8(_mm512_maskz_compress_epi16(events, polarity)));
      alignas(64) uint16_t low_of[32];
      _mm512_store_si512(low_of, _mm512_maskz_compress_epi16(events, low));
      const __m512i high = _mm512_set1_epi64(cursor.high);
      for (size_t k = 0; k < num_events; k += 8) {
        const __m512i t = _mm512_cvtepu16_epi64(_mm_load_si128(reinterpret_cast<const __m128i*>(low_of + k)));
        _mm512_storeu_si512(out.t + at + k, _mm512_or_si512(high, t));
      }
      out.count = at + num_events;
    }
    if (rows != 0) {
      const auto last = static_cast<size_t>(31 - std::countl_zero(rows));
      cursor.y = load_le<uint16_t>(words + 2 * (i + last)) & kCoordinateMask;
    }
    cursor.low = last_low;
    i += used;
    if (used < 32) break;
  }
  return i;
}

#else

/// What a word of each type does in a run of plain words.
enum PlainClass : uint8_t { kIsEvent = 1, kIsRow = 2, kIsLow = 4, kIsPlain = 8 };
HWY_ALIGN constexpr uint8_t kPlainClasses[16] = {
    kIsRow | kIsPlain, 0,       kIsEvent | kIsPlain, 0, 0, 0, kIsLow | kIsPlain, kIsPlain, 0, 0, 0, 0, 0, 0,
    kIsPlain,          kIsPlain};

HWY_ALIGN constexpr uint8_t kEventsThenRows[16] = {kIsEvent, kIsEvent, kIsEvent, kIsEvent, kIsEvent, kIsEvent,
                                                   kIsEvent, kIsEvent, kIsRow,   kIsRow,   kIsRow,   kIsRow,
                                                   kIsRow,   kIsRow,   kIsRow,   kIsRow};
HWY_ALIGN constexpr uint8_t kLowsThenPlain[16] = {kIsLow,   kIsLow,   kIsLow,   kIsLow,   kIsLow,   kIsLow,
                                                  kIsLow,   kIsLow,   kIsPlain, kIsPlain, kIsPlain, kIsPlain,
                                                  kIsPlain, kIsPlain, kIsPlain, kIsPlain};

/// The words of a group by what they do, as bits.
struct GroupKinds {
  uint32_t events, rows, lows;
  uint32_t used;  ///< plain words in front
};

HWY_INLINE GroupKinds kinds_of(hn::Vec<Group> word, hn::Vec<Group> time_high) {
  const Group d;
  const GroupBytes d8;
  const auto type = hn::BitCast(d8, hn::ShiftRight<12>(word));
  // The upper byte of a lane is looked up too, as type 0; narrowing drops it.
  const auto by_type = hn::BitCast(d, hn::TableLookupBytes(hn::Load(d8, kPlainClasses), type));
  const auto heartbeat = hn::IfThenElseZero(hn::Eq(word, time_high), hn::Set(d, uint16_t{kIsPlain}));
  const auto kinds = hn::And(hn::Or(by_type, heartbeat), hn::Set(d, uint16_t{0xFF}));
  const auto narrow = hn::DemoteTo(hn::Half<GroupBytes>(), hn::BitCast(SignedGroup(), kinds));
  const auto twice = hn::Combine(d8, narrow, narrow);
  const uint32_t events_rows = bytes_with(twice, hn::Load(d8, kEventsThenRows));
  const uint32_t lows_plain = bytes_with(twice, hn::Load(d8, kLowsThenPlain));
  const auto used = static_cast<uint32_t>(std::countr_one(lows_plain >> 8));
  const uint32_t taken = (1u << used) - 1;
  return {events_rows & taken, (events_rows >> 8) & taken, lows_plain & taken, used};
}

/// Stores four times `low` with `high` as 64-bit values.
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

/// The same for the first `count` of eight; writes four or eight.
HWY_INLINE void store_times(hn::Vec<Group> low, int64_t high, size_t count, int64_t* to) {
  const hn::Full128<uint32_t> d32;
  const hn::CappedTag<uint64_t, 4> d64;
  const hn::Half<Group> half;
  store_four_times(d64, hn::PromoteTo(d32, hn::LowerHalf(half, low)), high, to);
  if (count > 4) store_four_times(d64, hn::PromoteTo(d32, hn::UpperHalf(half, low)), high, to + 4);
}

/// take_plain_words() for eight words at a time, while eight are left; events of a group are compressed to the front.
size_t take_plain_groups(const uint8_t* words, size_t count, Cursor& cursor, Columns& out) {
  const Group d;
  const SignedGroup di;
  const GroupBytes d8;
  const auto time_high = hn::Set(d, static_cast<uint16_t>(cursor.time_high));
  const auto coordinate = hn::Set(d, static_cast<uint16_t>(kCoordinateMask));
  const auto payload = hn::Set(d, static_cast<uint16_t>(kPayloadMask));
  const auto last_low = hn::Set(di, static_cast<int16_t>(std::min<int64_t>(cursor.end_us - cursor.high, 4096) - 1));
  const int64_t high = cursor.high;
  const Columns to = out;
  auto low = hn::Set(d, static_cast<uint16_t>(cursor.low));
  auto y = hn::Set(d, static_cast<uint16_t>(cursor.y));
  size_t at = to.count;
  size_t i = 0;
  while (i + kGroupWords <= count) {
    const auto word = hn::LoadU(d, reinterpret_cast<const uint16_t*>(words + 2 * i));
    const GroupKinds kinds = kinds_of(word, time_high);
    if (kinds.used == 0) break;
    const auto lows = fill_forward(hn::And(word, payload), kinds.lows, low);
    const auto out_of_time = hn::Or(hn::Lt(steps_of(lows, low), hn::Zero(di)), hn::Gt(hn::BitCast(di, lows), last_low));
    if (!hn::AllFalse(di, out_of_time)) break;
    const auto place = hn::And(word, coordinate);
    const auto rows = fill_forward(place, kinds.rows, y);
    const auto chosen = hn::Load(d8, kLaneTables.compress[kinds.events]);
    const auto polarity = hn::And(hn::ShiftRight<11>(word), hn::Set(d, uint16_t{1}));
    const auto num_events = static_cast<size_t>(std::popcount(kinds.events));
    hn::StoreU(lanes_from(place, chosen), d, to.x + at);
    hn::StoreU(lanes_from(rows, chosen), d, to.y + at);
    hn::StoreU(hn::DemoteTo(hn::Half<GroupBytes>(), hn::BitCast(di, lanes_from(polarity, chosen))),
               hn::Half<GroupBytes>(), to.p + at);
    store_times(lanes_from(lows, chosen), high, num_events, to.t + at);
    at += num_events;
    low = last_in_all(lows);
    y = last_in_all(rows);
    // Not i += used: the next group's address must not wait for this one's kinds.
    if (kinds.used < kGroupWords) {
      i += kinds.used;
      break;
    }
    i += kGroupWords;
  }
  out.count = at;
  cursor.low = hn::GetLane(low);
  cursor.y = hn::GetLane(y);
  return i;
}

#endif

HWY_INLINE size_t take_plain(const uint8_t* words, size_t count, Cursor& cursor, Columns& out) {
#if HWY_TARGET == HWY_AVX3_DL
  constexpr size_t kGroup = 32, kOneByOne = 1;
#else
  constexpr size_t kGroup = kGroupWords, kOneByOne = kGroupWords;
#endif
  const size_t used = take_plain_groups(words, count, cursor, out);
  if (count - used >= kGroup) return used > 0 ? used : take_plain_words(words, kOneByOne, cursor, out);
  return used + take_plain_words(words + 2 * used, count - used, cursor, out);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::events::evt3
HWY_AFTER_NAMESPACE();

#endif
