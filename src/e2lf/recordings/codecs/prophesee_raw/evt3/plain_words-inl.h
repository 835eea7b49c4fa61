// SPDX-License-Identifier: MIT
// Decodes EVT3 words in groups of 32, for CPUs that can compress 16-bit lanes. Included once for each target.
#if defined(E2LF_EVENTS_EVT3_PLAIN_WORDS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_EVT3_PLAIN_WORDS_INL_H
#undef E2LF_EVENTS_EVT3_PLAIN_WORDS_INL_H
#else
#define E2LF_EVENTS_EVT3_PLAIN_WORDS_INL_H
#endif

#include <bit>

#include <hwy/highway.h>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/expand-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings::evt3 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX3_DL

using recordings::HWY_NAMESPACE::Columns;
using recordings::HWY_NAMESPACE::expand_mask;

/// The state that plain words change.
struct Cursor {
  int64_t high;        ///< time without its low bits
  uint32_t time_high;  ///< the TIME_HIGH word that repeats this time
  uint32_t low;
  uint32_t y;
};

/// The plain types: events, the words that determine their place, and ignored words. Others need a closer look.
constexpr uint32_t kPlainTypes =
    (1u << kAddrY) | (1u << kAddrX) | (1u << kTimeLow) | (1u << kContinued4) | (1u << kOthers) | (1u << kContinued12);

/// Returns the lanes shifted up by one, with `first` in lane 0.
HWY_INLINE __m512i move_up(__m512i values, int first) {
  const __m512i from =
      _mm512_setr_epi32(0x0000001F, 0x20001, 0x40003, 0x60005, 0x80007, 0xA0009, 0xC000B, 0xE000D, 0x10000F, 0x120011,
                        0x140013, 0x160015, 0x180017, 0x1A0019, 0x1C001B, 0x1E001D);
  return _mm512_mask_mov_epi16(_mm512_permutexvar_epi16(from, values), 1,
                               _mm512_set1_epi16(static_cast<int16_t>(first)));
}

/// Returns for each lane the number of lanes up to and including it that are set in `bits`.
HWY_INLINE __m512i count_up_to_lane(uint32_t bits) {
  const __m512i all = _mm512_set1_epi32(static_cast<int>(bits));
  const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m512i up_to = _mm512_sub_epi32(_mm512_sllv_epi32(_mm512_set1_epi32(2), lane), _mm512_set1_epi32(1));
  const __m512i up_to_high = _mm512_or_si512(_mm512_slli_epi32(up_to, 16), _mm512_set1_epi32(0xFFFF));
  const __m512i first = _mm512_popcnt_epi32(_mm512_and_si512(all, up_to));
  const __m512i second = _mm512_popcnt_epi32(_mm512_and_si512(all, up_to_high));
  return _mm512_inserti64x4(_mm512_castsi256_si512(_mm512_cvtepi32_epi16(first)), _mm512_cvtepi32_epi16(second), 1);
}

/// Returns for each lane the value of the last lane up to and including it that is set in `bits`, or `before` if there
/// is none.
HWY_INLINE __m512i fill_forward(__m512i values, uint32_t bits, uint32_t before) {
  const __m512i index = _mm512_sub_epi16(count_up_to_lane(bits), _mm512_set1_epi16(1));
  const __m512i filled = _mm512_permutexvar_epi16(index, _mm512_maskz_compress_epi16(bits, values));
  const uint32_t in_front = bits != 0 ? (bits & (0 - bits)) - 1 : 0xFFFFFFFF;
  return _mm512_mask_mov_epi16(filled, in_front, _mm512_set1_epi16(static_cast<int16_t>(before)));
}

/// Decodes plain words up to the first that is not plain, or in whose group of 32 time moves back. No branch depends on
/// the order of the types. The events of a group are compressed to the front. Returns the number of words used.
HWY_INLINE size_t take_plain(const uint8_t* words, size_t count, Cursor& cursor, Columns& out) {
  const __m512i coordinate_mask = _mm512_set1_epi16(kCoordinateMask);
  size_t i = 0;
  while (i < count) {
    const uint32_t present = count - i >= 32 ? 0xFFFFFFFF : (1u << (count - i)) - 1;
    const __m512i word = _mm512_maskz_loadu_epi16(present, words + 2 * i);
    const __m512i type = _mm512_srli_epi16(word, 12);
    const __m512i type_bit = _mm512_sllv_epi16(_mm512_set1_epi16(1), type);
    uint32_t plain = _mm512_test_epi16_mask(type_bit, _mm512_set1_epi16(static_cast<int16_t>(kPlainTypes)));
    plain |= _mm512_cmpeq_epi16_mask(word, _mm512_set1_epi16(static_cast<int16_t>(cursor.time_high)));
    const auto used = static_cast<uint32_t>(std::countr_one(plain & present));
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
      if (back) break;
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

/// Computes the 32-bit mask of a vector of 12, 12 and 8 pixels that begins here; returns false if another word is among
/// the three.
HWY_INLINE bool load_triple(const uint8_t* words, uint32_t& mask) {
  const auto a = load_le<uint16_t>(words);
  const auto b = load_le<uint16_t>(words + 2);
  const auto c = load_le<uint16_t>(words + 4);
  mask = (a & 0xFFFu) | ((b & 0xFFFu) << 12) | (static_cast<uint32_t>(c) << 24);
  return (a >> 12) == kVect12 && (b >> 12) == kVect12 && (c >> 12) == kVect8;
}

/// Decodes runs of plain words and of vectors with the kernels above, and the rest with the scalar reference, word by
/// word.
size_t decode_columns(const uint8_t* words, size_t count, Evt3State& state, const SensorLimits& limits,
                      ColumnSink& sink) {
  Columns out{sink.x, sink.y, sink.p, sink.t, sink.count};
  sink.set_time(Evt3WordCodec::time(state));
  size_t i = 0;
  while (i < count) {
    // The kernels use times as they are, so they cannot run while the time is raised to that of an earlier event.
    const int64_t time = Evt3WordCodec::time(state);
    if (sink.time() == time) {
      Cursor cursor{state.high_us, state.time_high, state.low, state.y};
      for (;;) {
        const uint32_t word = load_le<uint16_t>(words + 2 * i);
        uint32_t mask = 0;
        const uint32_t base = state.base_x;
        if (word >> 12 == kVectBaseX) {
          state.base_x = static_cast<uint16_t>(word & kCoordinateMask);
          state.base_p = static_cast<uint8_t>((word >> 11) & 1);
          ++i;
        } else if (word >> 12 == kVect12 && i + 3 <= count && base + 32 <= limits.width &&
                   load_triple(words + 2 * i, mask)) {
          expand_mask(mask, base, cursor.y, state.base_p, cursor.high | cursor.low, out);
          state.base_x = static_cast<uint16_t>(base + 32);
          i += 3;
        } else {
          const size_t used = take_plain(words + 2 * i, count - i, cursor, out);
          i += used;
          if (used == 0) break;
        }
        if (i == count) break;
      }
      state.low = static_cast<uint16_t>(cursor.low);
      state.y = static_cast<uint16_t>(cursor.y);
      sink.count = out.count;
      if (i == count) break;
    }
    Evt3WordCodec::decode_scalar(words + 2 * i, 1, state, limits, sink);
    sink.set_time(Evt3WordCodec::time(state));
    out.count = sink.count;
    ++i;
  }
  return count;
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings::evt3
HWY_AFTER_NAMESPACE();

#endif
