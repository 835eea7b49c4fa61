// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>

#include "e2lf/events/evt3/evt3_decoder.h"

#define HWY_WANT_AVX3_DL 1
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/events/evt3/evt3_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/events/evt3/lane_groups-inl.h"
#include "e2lf/events/evt3/plain_words-inl.h"
#include "e2lf/events/raw/expand-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::events::evt3 {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128

size_t check_words(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  return check_scalar(words, count, check, limits);
}
size_t decode_columns(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
  return decode_scalar(words, count, state, limits, sink);
}
size_t decode_images(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ImageSink& sink) {
  return decode_scalar(words, count, state, limits, sink);
}

#else

namespace hn = hwy::HWY_NAMESPACE;
using events::HWY_NAMESPACE::add_mask_to_row;
using events::HWY_NAMESPACE::Columns;
using events::HWY_NAMESPACE::expand_mask;

/// Classes of types in the check, one bit each.
enum Class : uint8_t { kBad = 1, kHigh = 2, kLow = 4, kRow = 8, kColumn = 16 };

HWY_ALIGN constexpr uint8_t kClasses[16] = {kRow,  kBad, kColumn, kColumn, 0,    0,    kLow, 0,
                                            kHigh, kBad, 0,       kBad,    kBad, kBad, 0,    0};

/// Bits of a mask over at most 32 lanes.
template <typename D>
HWY_INLINE uint32_t bits_of(D d, hn::Mask<D> mask) {
  alignas(8) uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return load_le<uint32_t>(bytes);
}

#if HWY_TARGET == HWY_AVX3_DL

/// Whether the TIME_LOW words of a group (their lanes in `bits`, not 0) go on plausibly from `low` (not -1); takes over
/// the last one.
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

size_t check_words(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  const hn::CappedTag<uint16_t, 32> d;
  const hn::Repartition<uint8_t, decltype(d)> d8;
  const hn::Rebind<int16_t, decltype(d)> di;
  const size_t lanes = hn::Lanes(d);
  const auto classes = hn::LoadDup128(d8, kClasses);
  const auto last_row = hn::Set(di, static_cast<int16_t>(limits.height - 1));
  const auto last_column = hn::Set(di, static_cast<int16_t>(limits.width - 1));
  const auto zero = hn::Zero(d);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto word = hn::LoadU(d, reinterpret_cast<const uint16_t*>(words + 2 * i));
    const auto type = hn::BitCast(d8, hn::ShiftRight<12>(word));
    const auto kind =
        hn::And(hn::BitCast(d, hn::TableLookupBytes(classes, type)), hn::Set(d, static_cast<uint16_t>(0xFF)));
    const auto is = [&](uint16_t bit) { return hn::TestBit(kind, hn::Set(d, bit)); };
    const auto place = hn::BitCast(di, hn::And(word, hn::Set(d, static_cast<uint16_t>(kCoordinateMask))));
    const auto outside_row = hn::And(hn::RebindMask(di, is(kRow)), hn::Gt(place, last_row));
    const auto outside_column = hn::And(hn::RebindMask(di, is(kColumn)), hn::Gt(place, last_column));
    const auto is_high = is(kHigh);
    const auto new_high = hn::And(is_high, hn::Ne(word, hn::Set(d, check.time_high)));
    const auto odd = hn::Or(hn::Or(is(kBad), hn::Eq(word, zero)),
                            hn::Or(new_high, hn::RebindMask(d, hn::Or(outside_row, outside_column))));
    if (!hn::AllFalse(d, odd)) {
      const size_t good = check_scalar(words + 2 * i, lanes, check, limits);
      if (good < lanes) return i + good;
      continue;
    }
    const auto is_low = is(kLow);
    if (!hn::AllFalse(d, is_low)) {
      const uint32_t low_bits = bits_of(d, is_low);
      if (check.low < 0 || !check_lows(words + 2 * i, low_bits, check.low)) {
        const size_t good = check_scalar(words + 2 * i, lanes, check, limits);
        if (good < lanes) return i + good;
        continue;
      }
    }
    check.num_zeros = 0;
    const size_t highs = hn::CountTrue(d, is_high);
    check.heartbeat += static_cast<int64_t>(highs);
    if (highs > 0) check.num_rejected = 0;
  }
  return i + check_scalar(words + 2 * i, count - i, check, limits);
}

/// The 32-bit mask of a vector of 12, 12 and 8 pixels that begins here; false when another word is among the three.
HWY_INLINE bool load_triple(const uint8_t* words, uint32_t& mask) {
  const auto a = load_le<uint16_t>(words);
  const auto b = load_le<uint16_t>(words + 2);
  const auto c = load_le<uint16_t>(words + 4);
  mask = (a & 0xFFFu) | ((b & 0xFFFu) << 12) | (static_cast<uint32_t>(c) << 24);
  return (a >> 12) == kVect12 && (b >> 12) == kVect12 && (c >> 12) == kVect8;
}

/// Events to the columns of a sink.
struct ToColumns {
  ColumnSink& sink;
  Columns out;

  explicit ToColumns(ColumnSink& target) : sink(target), out{target.x, target.y, target.p, target.t, target.count} {}
  [[nodiscard]] static bool is_open() { return true; }
  [[nodiscard]] static int64_t end_us() { return INT64_MAX; }
  [[nodiscard]] static size_t room() { return SIZE_MAX; }
  void flush() { sink.count = out.count; }
  void reload() { out.count = sink.count; }
  void add_vector(uint32_t mask, uint32_t x, uint32_t y, uint32_t p, int64_t t) {
    expand_mask<32>(mask, x, y, p, t, out);
  }
};

/// Events to images, in their order: few at one time by way of some columns, many straight to their row, so that the
/// pixels can be brought near before they are counted.
class ToImages {
 public:
  Columns out{x_, y_, p_, t_, 0};

  explicit ToImages(ImageSink& target) : sink_(target) {}
  [[nodiscard]] bool is_open() const { return sink_.is_open() && sink_.image() != nullptr; }
  [[nodiscard]] int64_t end_us() const { return sink_.slice_end_us(); }
  /// How many events `out` takes.
  [[nodiscard]] size_t room() {
    if (out.count > kColumns / 2) flush_columns();
    return kColumns - out.count;
  }
  void flush() {
    flush_columns();
    flush_rows();
  }
  void reload() {}
  void add_vector(uint32_t mask, uint32_t base, uint32_t row, uint32_t polarity, int64_t time) {
    const int count = std::popcount(mask);
    if (count <= kFew) {
      if (out.count > kColumns - 32) flush_columns();
      expand_mask<32>(mask, base, row, polarity, time, out);
      return;
    }
    flush_columns();
    sink_.set_time(time);
    (polarity != 0 ? sink_.on : sink_.off) += static_cast<uint64_t>(count);
    sink_.prefetch_pixel(base, row);
    sink_.prefetch_pixel(base + 31, row);
    if (num_rows_ >= kRows) add(rows_[num_rows_ % kRows]);
    rows_[num_rows_++ % kRows] = {sink_.image() + row * sink_.width() + base, mask, polarity != 0 ? 1 : -1};
  }

 private:
  static constexpr size_t kColumns = 512, kRows = 16;
  static constexpr int kFew = 8;

  struct Row {
    int16_t* pixels;
    uint32_t mask;
    int step;
  };

  static void add(const Row& row) { add_mask_to_row(row.mask, row.step, row.pixels); }
  void flush_columns() {
    if (out.count == 0) return;
    flush_rows();
    sink_.add_block(x_, y_, p_, t_, out.count);
    out.count = 0;
  }
  void flush_rows() {
    for (size_t i = num_rows_ - std::min(num_rows_, kRows); i < num_rows_; ++i) add(rows_[i % kRows]);
    num_rows_ = 0;
  }

  ImageSink& sink_;
  uint16_t x_[kColumns + kSinkSlack];
  uint16_t y_[kColumns + kSinkSlack];
  uint8_t p_[kColumns + kSinkSlack];
  int64_t t_[kColumns + kSinkSlack];
  Row rows_[kRows];
  size_t num_rows_ = 0;
};

/// Runs of plain words and of vectors by the kernels above, the rest by the scalar reference, word by word.
template <typename Target, typename Sink>
HWY_INLINE size_t decode_words(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, Sink& sink,
                               Target& target) {
  sink.set_time(Codec::time(state));
  size_t i = 0;
  while (i < count) {
    // The kernels take time as it comes: not while it is held up by an earlier event, or after the last slice.
    const int64_t time = Codec::time(state);
    if (target.is_open() && sink.time() == time) {
      Cursor cursor{state.high_us, target.end_us(), state.time_high, state.low, state.y};
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
          target.add_vector(mask, base, cursor.y, state.base_p, cursor.high | cursor.low);
          state.base_x = static_cast<uint16_t>(base + 32);
          i += 3;
        } else {
          const size_t used = take_plain(words + 2 * i, std::min(count - i, target.room()), cursor, target.out);
          i += used;
          if (used == 0) break;
        }
        if (i == count) break;
      }
      state.low = static_cast<uint16_t>(cursor.low);
      state.y = static_cast<uint16_t>(cursor.y);
      target.flush();
      if (i == count) break;
    }
    if (decode_scalar(words + 2 * i, 1, state, limits, sink) == 0) return i;
    sink.set_time(Codec::time(state));
    target.reload();
    ++i;
  }
  return count;
}

size_t decode_columns(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
  ToColumns target(sink);
  return decode_words(words, count, state, limits, sink, target);
}

size_t decode_images(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ImageSink& sink) {
  if (limits.width > sink.width() || limits.height > sink.height()) {
    return decode_scalar(words, count, state, limits, sink);
  }
  ToImages target(sink);
  return decode_words(words, count, state, limits, sink, target);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::events::evt3
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::events::evt3 {

HWY_EXPORT(check_words);
HWY_EXPORT(decode_columns);
HWY_EXPORT(decode_images);

size_t Codec::check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  return HWY_DYNAMIC_DISPATCH(check_words)(words, count, check, limits);
}

size_t Codec::decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
  return HWY_DYNAMIC_DISPATCH(decode_columns)(words, count, state, limits, sink);
}

size_t Codec::decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ImageSink& sink) {
  return HWY_DYNAMIC_DISPATCH(decode_images)(words, count, state, limits, sink);
}

}  // namespace e2lf::events::evt3
#endif
