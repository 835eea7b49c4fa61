// SPDX-License-Identifier: MIT
// The kernels of timed_words.h.
#include <algorithm>
#include <utility>

#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_words.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/recordings/codecs/prophesee_raw/timed/timed_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/recordings/codecs/prophesee_raw/stream/expand-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings::timed {
namespace HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128

template <Encoding kEncoding>
constexpr Kernels kKernels = {Words<kEncoding>::check_scalar, Words<kEncoding>::decode_scalar};

#else

namespace hn = hwy::HWY_NAMESPACE;
using recordings::HWY_NAMESPACE::Columns;
using recordings::HWY_NAMESPACE::expand_mask;

using Heads = hn::ScalableTag<uint32_t>;

/// Loads the heads of the next Lanes(d) words.
template <typename Words>
HWY_INLINE hn::Vec<Heads> load_heads(Heads d, const uint8_t* words) {
  const auto* halves = reinterpret_cast<const uint32_t*>(words);
  if constexpr (Words::kWordBytes == 4) {
    return hn::LoadU(d, halves);
  } else {
    hn::Vec<Heads> first, second;
    hn::LoadInterleaved2(d, halves, first, second);
    return Words::kHeadOffset == 0 ? first : second;
  }
}

template <typename Words>
size_t check_words(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  const Heads d;
  const hn::RebindToSigned<Heads> di;
  const size_t lanes = hn::Lanes(d);
  const auto coordinate = hn::Set(d, 0x7FFu);
  const auto last_x = hn::Set(di, static_cast<int32_t>(limits.width) - 1);
  const auto last_y = hn::Set(di, static_cast<int32_t>(limits.height) - 1);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto head = load_heads<Words>(d, words + i * Words::kWordBytes);
    const auto type = hn::ShiftRight<28>(head);
    const auto is = [&](uint32_t value) { return hn::Eq(type, hn::Set(d, value)); };
    const auto event = hn::Or(is(kOff), is(kOn));
    const auto x = hn::BitCast(di, hn::And(hn::ShiftRight<11>(head), coordinate));
    const auto y = hn::BitCast(di, hn::And(head, coordinate));
    const auto outside = hn::RebindMask(d, hn::Or(hn::Gt(x, last_x), hn::Gt(y, last_y)));
    const auto repeated = hn::Eq(head, hn::Set(d, (uint32_t{kTimeHigh} << 28) | check.time_high));
    const auto ignored = hn::Or(is(kOthers), is(kContinued));
    const auto plain = hn::Or(hn::AndNot(hn::Or(outside, hn::Eq(head, hn::Zero(d))), event),
                              hn::Or(hn::Or(repeated, ignored), is(kTrigger)));
    if (!hn::AllTrue(d, plain)) {
      const size_t good = Words::check_scalar(words + i * Words::kWordBytes, lanes, check, limits);
      if (good < lanes) return i + good;
      continue;
    }
    check.num_zeros = 0;
    const size_t highs = hn::CountTrue(d, repeated);
    check.heartbeat += static_cast<int64_t>(highs);
    if (highs > 0) check.num_rejected = 0;
  }
  return i + Words::check_scalar(words + i * Words::kWordBytes, count - i, check, limits);
}

/// Decodes EVT2 events up to the first word that is not an event or moves time back. At least one vector of words and
/// one more word must be available. Returns the number of words used.
HWY_INLINE size_t take_events(const uint8_t* words, size_t count, int64_t high_us, Columns& columns) {
  const Heads d;
  const hn::RebindToSigned<Heads> di;
  const hn::Rebind<uint16_t, Heads> d16;
  const hn::Rebind<uint8_t, Heads> d8;
  const hn::Half<Heads> half;
  const hn::RepartitionToWide<Heads> d64;
  const size_t lanes = hn::Lanes(d);
  const auto coordinate = hn::Set(d, 0x7FFu);
  const auto low_mask = hn::Set(d, 0x3Fu);
  const auto high = hn::Set(d64, static_cast<uint64_t>(high_us));
  const Columns to = columns;
  size_t at = to.count;
  size_t i = 0;
  while (i + lanes < count) {
    const auto head = hn::LoadU(d, reinterpret_cast<const uint32_t*>(words + 4 * i));
    const auto next = hn::LoadU(d, reinterpret_cast<const uint32_t*>(words + 4 * i + 4));
    const auto low = hn::And(hn::ShiftRight<22>(head), low_mask);
    const auto next_low = hn::And(hn::ShiftRight<22>(next), low_mask);
    const auto not_event = hn::Ne(hn::ShiftRight<29>(head), hn::Zero(d));
    const auto back = hn::Gt(hn::BitCast(di, low), hn::BitCast(di, next_low));
    hn::StoreU(hn::DemoteTo(d16, hn::BitCast(di, hn::And(hn::ShiftRight<11>(head), coordinate))), d16, to.x + at);
    hn::StoreU(hn::DemoteTo(d16, hn::BitCast(di, hn::And(head, coordinate))), d16, to.y + at);
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(di, hn::ShiftRight<28>(head))), d8, to.p + at);
    auto* t = reinterpret_cast<uint64_t*>(to.t + at);
    hn::StoreU(hn::Or(high, hn::PromoteTo(d64, hn::LowerHalf(half, low))), d64, t);
    hn::StoreU(hn::Or(high, hn::PromoteTo(d64, hn::UpperHalf(half, low))), d64, t + lanes / 2);
    const intptr_t stop = hn::FindFirstTrue(d, not_event);
    const intptr_t turn = hn::FindFirstTrue(d, hn::RebindMask(d, back));
    size_t used = stop < 0 ? lanes : static_cast<size_t>(stop);
    // If the word after a turn is an event, it goes back in time.
    if (turn >= 0 && static_cast<size_t>(turn) + 1 < used) used = static_cast<size_t>(turn) + 1;
    at += used;
    i += used;
    if (used < lanes || turn >= 0) break;
  }
  columns.count = at;
  return i;
}

/// Does the same for EVT2.1: words of up to 32 events.
template <typename Words>
HWY_INLINE size_t take_masks(const uint8_t* words, size_t count, int64_t high_us, const SensorLimits& limits,
                             Columns& columns) {
  Columns to = columns;
  uint32_t last_low = 0;
  size_t i = 0;
  for (; i < count; ++i) {
    const uint32_t head = Words::head_of(words + i * Words::kWordBytes);
    const uint32_t low = low_of(head);
    const uint32_t x = x_of(head);
    if (type_of(head) > kOn || low < last_low || x + 32 > limits.width) break;
    expand_mask(Words::mask_of(words + i * Words::kWordBytes), x, y_of(head), type_of(head), high_us | low, to);
    last_low = low;
  }
  columns.count = to.count;
  return i;
}

template <typename Words>
size_t decode_words(const uint8_t* words, size_t count, TimedState& state, const SensorLimits& limits,
                    ColumnSink& sink) {
  for (size_t i = 0; i < count;) {
    const uint8_t* word = words + i * Words::kWordBytes;
    const uint32_t head = Words::head_of(word);
    size_t used = 0;
    if (type_of(head) <= kOn && (state.high_us | low_of(head)) >= sink.latest()) {
      Columns out{sink.x, sink.y, sink.p, sink.t, sink.count};
      if constexpr (Words::kWordBytes == 4) {
        used = take_events(word, count - i, state.high_us, out);
      } else {
        used = take_masks<Words>(word, count - i, state.high_us, limits, out);
      }
      sink.count = out.count;
    }
    if (used == 0) used = Words::decode_scalar(word, 1, state, limits, sink);
    i += used;
  }
  return count;
}

template <Encoding kEncoding>
constexpr Kernels kKernels = {check_words<Words<kEncoding> >, decode_words<Words<kEncoding> >};

#endif

Kernels find_kernels(Encoding encoding) {
  if (encoding == Encoding::kEvt2) return kKernels<Encoding::kEvt2>;
  return encoding == Encoding::kEvt21Little ? kKernels<Encoding::kEvt21Little> : kKernels<Encoding::kEvt21Legacy>;
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings::timed
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::recordings::timed {

HWY_EXPORT(find_kernels);

Kernels kernels(Encoding encoding) {
  return HWY_DYNAMIC_DISPATCH(find_kernels)(encoding);
}

namespace {

constexpr size_t kLookedAt = 512;

/// Returns the number of valid words before the first invalid one, in steps and up to a limit, and that of all valid
/// ones: a damaged word ends the first count in both byte orders, whatever the words after it are.
template <Encoding kEncoding>
std::pair<size_t, size_t> good_words(std::span<const uint8_t> words) {
  constexpr size_t kStep = 8;
  const auto bad_among = [words](size_t count, size_t enough) {
    return Words<kEncoding>::count_bad(words.data(), count, enough);
  };
  const size_t count = std::min(words.size() / 8, kLookedAt);
  size_t good = 0;
  while (good < count && bad_among(std::min(good + kStep, count), 1) == 0) good = std::min(good + kStep, count);
  return {good, count - bad_among(count, count)};
}

}  // namespace

Encoding find_byte_order(std::span<const uint8_t> words, const std::string& hint) {
  const auto little = good_words<Encoding::kEvt21Little>(words), legacy = good_words<Encoding::kEvt21Legacy>(words);
  const bool is_legacy = little == legacy ? hint == "legacy" : little < legacy;
  return is_legacy ? Encoding::kEvt21Legacy : Encoding::kEvt21Little;
}

}  // namespace e2lf::recordings::timed
#endif
