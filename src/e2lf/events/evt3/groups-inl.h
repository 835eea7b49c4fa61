// SPDX-License-Identifier: MIT
// EVT3 words in groups of eight, for CPUs that do not compress 16-bit lanes. Included once for each target.
#if defined(E2LF_EVENTS_EVT3_GROUPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_EVT3_GROUPS_INL_H
#undef E2LF_EVENTS_EVT3_GROUPS_INL_H
#else
#define E2LF_EVENTS_EVT3_GROUPS_INL_H
#endif

#include <algorithm>
#include <bit>

#include <hwy/highway.h>

#include "e2lf/events/evt3/evt3_decoder.h"
#include "e2lf/events/evt3/group_targets-inl.h"
#include "e2lf/events/evt3/lane_groups-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::events::evt3 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_AVX3_DL

/// What words that bring events depend on.
struct Cursor {
  uint32_t low;
  uint32_t y;
  uint32_t base_x;
  uint32_t base_p;
};

/// 255 for the types that are not plain: plain are single events, what places them, and what is ignored.
HWY_ALIGN constexpr uint8_t kNotPlain[16] = {0, 255, 0, 255, 255, 255, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0};

/// Words that take_vectors() may look at from one on.
constexpr size_t kVectorWords = 4;

/// Decodes vectors and their bases, of which the first word is one, up to another word or a vector that reaches beyond
/// the sensor or has no base. Returns how many words were used.
template <typename Target>
HWY_INLINE size_t take_vectors(const uint8_t* words, size_t count, uint32_t width, Cursor& cursor, Target& target) {
  constexpr uint64_t kTripleTypes = 0xF000F000F000, kTriple = 0x500040004000;
  const uint32_t low = cursor.low, y = cursor.y;
  uint32_t base = cursor.base_x, polarity = cursor.base_p;
  size_t i = 0;
  while (i + kVectorWords <= count) {
    const auto next = load_le<uint64_t>(words + 2 * i);
    const auto type = static_cast<uint32_t>(next >> 12) & 0xF;
    if (type == kVectBaseX) {
      base = static_cast<uint32_t>(next) & kCoordinateMask;
      polarity = static_cast<uint32_t>(next >> 11) & 1;
      ++i;
    } else if ((next & kTripleTypes) == kTriple && base + 32 <= width) {
      target.put_vector(static_cast<uint32_t>((next & 0xFFF) | (next >> 4 & 0xFFF000) | (next >> 8 & 0xFF000000)), base,
                        y, polarity, low);
      base += 32;
      i += 3;
    } else {
      const uint32_t bits = type == kVect8 ? 8 : 12;
      if ((type != kVect8 && type != kVect12) || base + bits > width) break;
      target.put_vector(static_cast<uint32_t>(next) & ((1u << bits) - 1), base, y, polarity, low);
      base += bits;
      ++i;
    }
  }
  cursor.base_x = base;
  cursor.base_p = polarity;
  return i;
}

/// Decodes words up to the first that needs a closer look, brings a time before the last one or after `last_low`, or is
/// among the last few. No branch depends on the order of plain words. Returns how many words were used.
template <typename Target>
HWY_INLINE size_t take_words(const uint8_t* words, size_t count, uint32_t time_high_word, int64_t last_low_us,
                             uint32_t width, Cursor& cursor, Target& target) {
  const Group d;
  const SignedGroup di;
  const auto not_plain = hn::Load(GroupBytes(), kNotPlain);
  const auto time_high = hn::Set(d, static_cast<uint16_t>(time_high_word));
  const auto last_low = hn::Set(di, static_cast<int16_t>(last_low_us));
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
    const auto is_late = hn::Gt(hn::BitCast(di, lows), last_low);
    const auto is_back = hn::Lt(hn::BitCast(di, lows), hn::BitCast(di, before));
    if (!hn::AllFalse(di, hn::Or(is_late, is_back))) break;

    const auto x = hn::And(word, hn::Set(d, uint16_t{kCoordinateMask}));
    const auto rows = fill_forward(x, rows_lows & taken, y);
    target.put_events(word, x, rows, lows, stops_events >> 8 & taken);
    low = last_in_all(lows);
    y = last_in_all(rows);
    i += kGroupWords;
    if (used < kGroupWords) {
      i -= kGroupWords - used;
      cursor.low = hn::GetLane(low);
      cursor.y = hn::GetLane(y);
      const size_t in_vectors = take_vectors(words + 2 * i, count - i, width, cursor, target);
      if (in_vectors == 0) break;
      i += in_vectors;
    }
    target.make_room();
  }
  cursor.low = hn::GetLane(low);
  cursor.y = hn::GetLane(y);
  return i;
}

/// Groups of words by the kernels above, what they leave by the scalar reference.
template <typename Target, typename Sink>
HWY_INLINE size_t decode_words(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, Sink& sink,
                               Target& target) {
  sink.set_time(Codec::time(state));
  for (size_t i = 0; i < count;) {
    // The kernels take time as it comes: not while it is held up by an earlier event, or after the last slice.
    if (target.is_open() && sink.time() == Codec::time(state)) {
      const int64_t last_low = std::clamp<int64_t>(target.end_us() - state.high_us, 0, 4096) - 1;
      Cursor cursor{state.low, state.y, state.base_x, state.base_p};
      target.begin(state.high_us);
      i += take_words(words + 2 * i, count - i, state.time_high, last_low, limits.width, cursor, target);
      target.end();
      state.low = static_cast<uint16_t>(cursor.low);
      state.y = static_cast<uint16_t>(cursor.y);
      state.base_x = static_cast<uint16_t>(cursor.base_x);
      state.base_p = static_cast<uint8_t>(cursor.base_p);
    }
    const size_t left = std::min(count - i, kGroupWords);
    const size_t used = decode_scalar(words + 2 * i, left, state, limits, sink);
    i += used;
    if (used < left) return i;
    sink.set_time(Codec::time(state));
  }
  return count;
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::events::evt3
HWY_AFTER_NAMESPACE();

#endif
