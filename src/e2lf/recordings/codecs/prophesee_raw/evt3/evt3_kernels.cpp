// SPDX-License-Identifier: MIT
// Implements the vector kernels of evt3_decoder.h: the check of words and searches here, decoding in the headers.
#include <algorithm>
#include <bit>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"

#define HWY_WANT_AVX3_DL 1
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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
size_t decode_columns(const uint8_t* words, size_t count, Evt3State& state, const SensorLimits& limits,
                      ColumnSink& sink) {
  return Evt3WordCodec::decode_scalar(words, count, state, limits, sink);
}
size_t find_mark_in(const uint8_t* words, size_t count, uint16_t time_high) {
  return find_mark_scalar(words, count, time_high);
}
size_t find_last_in(const uint8_t* words, size_t count, TypeSet types) {
  return find_last_scalar(words, count, types);
}

#else

/// Returns the bits of a mask over at most 32 lanes.
template <typename D>
HWY_INLINE uint32_t bits_of(D d, hn::Mask<D> mask) {
  alignas(8) uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return load_le<uint32_t>(bytes);
}

#if HWY_TARGET == HWY_AVX3_DL

/// Returns whether the TIME_LOW words of a group (their lanes in `bits`, not 0) continue plausibly from `low` (not -1),
/// which is set to the last one.
HWY_INLINE bool check_lows(const uint8_t* words, uint32_t bits, int& low) {
  const __m512i payload = _mm512_and_si512(_mm512_loadu_si512(words), _mm512_set1_epi16(kPayloadMask));
  const __m512i lows = _mm512_maskz_compress_epi16(bits, payload);
  const __m512i step = _mm512_sub_epi16(lows, move_up(lows, low));
  const uint32_t back = _mm512_cmplt_epi16_mask(step, _mm512_set1_epi16(-kJitterUs));
  const uint32_t ahead = _mm512_cmpgt_epi16_mask(step, _mm512_set1_epi16(kLongStepUs));
  const auto lanes = static_cast<uint32_t>((uint64_t{1} << std::popcount(bits)) - 1);
  if (((back | ahead) & lanes) != 0) return false;
  low = load_le<uint16_t>(words + 2 * static_cast<size_t>(31 - std::countl_zero(bits))) & 0xFFF;
  return true;
}

#else

HWY_INLINE bool check_lows(const uint8_t* words, uint32_t bits, int& low) {
  const Group d;
  const SignedGroup di;
  auto last = hn::Set(d, static_cast<uint16_t>(low));
  auto bad = hn::MaskFromVec(hn::Zero(di));
  for (; bits != 0; bits >>= kGroupWords, words += 2 * kGroupWords) {
    const auto payload = hn::And(hn::LoadU(d, reinterpret_cast<const uint16_t*>(words)),
                                 hn::Set(d, static_cast<uint16_t>(kPayloadMask)));
    const auto lows = fill_forward(payload, bits & 0xFF, last);
    const auto steps = steps_of(lows, last);
    bad = hn::Or(bad, hn::Or(hn::Lt(steps, hn::Set(di, static_cast<int16_t>(-kJitterUs))),
                             hn::Gt(steps, hn::Set(di, static_cast<int16_t>(kLongStepUs)))));
    last = last_in_all(lows);
  }
  if (!hn::AllFalse(di, bad)) return false;
  low = hn::GetLane(last);
  return true;
}

#endif

/// The smallest and the largest lane of some words. is_wide is true if they are far apart within a group of eight
/// lanes, or if a group lies far below the previous one.
struct Range {
  int least, largest;
  bool is_wide;
};

/// Returns the range of the words whose lanes have all bits set in `chosen`; empty and not wide if there are none.
template <typename D>
HWY_INLINE Range range_of(D d, hn::Vec<D> word, hn::Vec<D> chosen) {
  if constexpr (hn::MaxLanes(D()) > kGroupWords) {
    const hn::Half<D> half;
    const Range a = range_of(half, hn::LowerHalf(half, word), hn::LowerHalf(half, chosen));
    const Range b = range_of(half, hn::UpperHalf(half, word), hn::UpperHalf(half, chosen));
    const bool goes_back = b.least + kJitterUs < a.largest;  // from one half to the next
    return {std::min(a.least, b.least), std::max(a.largest, b.largest), a.is_wide || b.is_wide || goes_back};
  } else {
    const int least = hn::GetLane(hn::MinOfLanes(d, hn::Or(word, hn::Not(chosen))));
    const int largest = 0xFFFF - hn::GetLane(hn::MinOfLanes(d, hn::Not(hn::And(word, chosen))));
    return {least, largest, largest - least > kJitterUs};
  }
}

/// Returns whether the TIME_LOW words of a vector of words, if there are any, continue plausibly from `low` (-1 =
/// unknown), which is set to the last one. Most do because they are close to each other, which can be decided without
/// their order.
template <typename D>
HWY_INLINE bool check_group_lows(const uint8_t* words, D d, hn::Vec<D> word, hn::Mask<D> is_low, int& low) {
  const uint32_t bits = bits_of(d, is_low);
  const Range range = range_of(d, word, hn::VecFromMask(d, is_low));
  const int last = low + static_cast<int>(kTimeLow << 12);
  if ((low < 0) | range.is_wide | (range.least < last) | (range.largest > last + kLongStepUs)) {
    return bits == 0 || (low >= 0 && check_lows(words, bits, low));
  }
  const auto at = static_cast<size_t>(31 - std::countl_zero(bits | 1));
  const int newest = load_le<uint16_t>(words + 2 * at) & static_cast<int>(kPayloadMask);
  low = bits != 0 ? newest : low;
  return true;
}

/// The largest coordinate of every type, as two tables of bytes; -1 for words that need a closer look.
struct CoordinateLimits {
  alignas(16) uint8_t low[16];
  alignas(16) uint8_t high[16];

  explicit CoordinateLimits(const SensorLimits& limits) {
    for (uint32_t type = 0; type < 16; ++type) {
      uint32_t limit = ((kKnownTypes >> type) & 1) != 0 && type != kTimeHigh ? kCoordinateMask : 0xFFFF;
      if (type == kAddrY) limit = std::min(limits.height - 1, kCoordinateMask);
      if (type == kAddrX || type == kVectBaseX) limit = std::min(limits.width - 1, kCoordinateMask);
      low[type] = static_cast<uint8_t>(limit);
      high[type] = static_cast<uint8_t>(limit >> 8);
    }
  }
};

size_t check_words(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
#if HWY_TARGET == HWY_AVX3_DL
  const hn::CappedTag<uint16_t, 32> d;
#else
  const hn::CappedTag<uint16_t, 16> d;
#endif
  const hn::Repartition<uint8_t, decltype(d)> d8;
  const hn::Rebind<int16_t, decltype(d)> di;
  const size_t lanes = hn::Lanes(d);
  const CoordinateLimits coordinates(limits);
  const auto limits_low = hn::LoadDup128(d8, coordinates.low);
  const auto limits_high = hn::LoadDup128(d8, coordinates.high);
  const auto coordinate = hn::Set(d, static_cast<uint16_t>(kCoordinateMask));
  const auto byte = hn::Set(d, uint16_t{0xFF});
  // Zero words are always inspected, so that they are handled where no time is known.
  const auto known_time_high = [&]() HWY_ATTR {
    return hn::Set(d, check.time_high == 0xFFFF ? uint16_t{0} : check.time_high);
  };
  auto time_high = known_time_high();
  size_t i = 0;
  size_t heartbeats = 0;
  const auto note_heartbeats = [&] {
    check.heartbeat += static_cast<int64_t>(heartbeats);
    if (heartbeats > 0) check.num_rejected = 0;
    heartbeats = 0;
  };
  // At high event rates, few vectors of words have a TIME_LOW. Then the check of the others is left out; where many
  // have one, the branch would cost more than the check.
  constexpr size_t kDensityGroups = 16, kFewWithLows = 3;
  size_t num_groups = 0, num_with_lows = 0;
  bool skips_others = false;
  bool stopped = false;
  while (!stopped && i + lanes <= count) {
    const auto word = hn::LoadU(d, reinterpret_cast<const uint16_t*>(words + 2 * i));
    const auto type = hn::ShiftRight<12>(word);
    const auto index = hn::BitCast(d8, type);
    const auto limit = hn::Or(hn::And(hn::BitCast(d, hn::TableLookupBytes(limits_low, index)), byte),
                              hn::ShiftLeft<8>(hn::BitCast(d, hn::TableLookupBytes(limits_high, index))));
    const auto is_heartbeat = hn::Eq(word, time_high);
    const auto is_beyond = hn::Gt(hn::BitCast(di, hn::And(word, coordinate)), hn::BitCast(di, limit));
    auto odd = hn::Or(hn::AndNot(is_heartbeat, hn::RebindMask(d, is_beyond)), hn::Eq(word, hn::Zero(d)));
    odd = hn::Or(odd, hn::Eq(word, hn::Set(d, kFrameEnd)));  // what follows may be padding
    const auto is_low = hn::Eq(type, hn::Set(d, static_cast<uint16_t>(kTimeLow)));
    const bool has_lows = !hn::AllFalse(d, is_low);
    num_with_lows += has_lows;
    if (++num_groups == kDensityGroups) {
      skips_others = num_with_lows <= kFewWithLows;
      num_groups = num_with_lows = 0;
    }
    if (check.after_frame || !hn::AllFalse(d, odd) ||
        ((has_lows | !skips_others) && !check_group_lows(words + 2 * i, d, word, is_low, check.low))) {
      note_heartbeats();
      const size_t good = check_scalar(words + 2 * i, lanes, check, limits);
      time_high = known_time_high();
      stopped = good < lanes;
      i += good;
      continue;
    }
    i += lanes;
    heartbeats += hn::CountTrue(d, is_heartbeat);
    check.num_zeros = 0;
  }
  note_heartbeats();
  return stopped ? i : i + check_scalar(words + 2 * i, count - i, check, limits);
}

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

size_t Evt3WordCodec::check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  return HWY_DYNAMIC_DISPATCH(check_words)(words, count, check, limits);
}

size_t Evt3WordCodec::decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits,
                             ColumnSink& sink) {
  return HWY_DYNAMIC_DISPATCH(decode_columns)(words, count, state, limits, sink);
}

}  // namespace e2lf::recordings::evt3
#endif
