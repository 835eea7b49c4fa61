// SPDX-License-Identifier: MIT
// The kernels of timed_codec.h.
#include <algorithm>
#include <bit>

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

template <typename Layout>
size_t check_words(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  return Words<Layout>::check_scalar(words, count, check, limits);
}
template <typename Layout>
size_t decode_words(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
  return Words<Layout>::decode_scalar(words, count, state, limits, sink);
}
#else

namespace hn = hwy::HWY_NAMESPACE;
using recordings::HWY_NAMESPACE::Columns;
using recordings::HWY_NAMESPACE::expand_mask;

using Heads = hn::ScalableTag<uint32_t>;

/// Loads the heads of the next Lanes(d) words.
template <typename Layout>
HWY_INLINE hn::Vec<Heads> load_heads(Heads d, const uint8_t* words) {
  const auto* halves = reinterpret_cast<const uint32_t*>(words);
  if constexpr (Layout::kWordBytes == 4) {
    return hn::LoadU(d, halves);
  } else {
    hn::Vec<Heads> first, second;
    hn::LoadInterleaved2(d, halves, first, second);
    return Layout::kHeadOffset == 0 ? first : second;
  }
}

template <typename Layout>
size_t check_words(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  using Scalar = Words<Layout>;
  const Heads d;
  const hn::RebindToSigned<Heads> di;
  const size_t lanes = hn::Lanes(d);
  const auto coordinate = hn::Set(d, 0x7FFu);
  const auto last_x = hn::Set(di, static_cast<int32_t>(limits.width) - 1);
  const auto last_y = hn::Set(di, static_cast<int32_t>(limits.height) - 1);
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto head = load_heads<Layout>(d, words + i * Layout::kWordBytes);
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
      const size_t good = Scalar::check_scalar(words + i * Layout::kWordBytes, lanes, check, limits);
      if (good < lanes) return i + good;
      continue;
    }
    check.num_zeros = 0;
    const size_t highs = hn::CountTrue(d, repeated);
    check.heartbeat += static_cast<int64_t>(highs);
    if (highs > 0) check.num_rejected = 0;
  }
  return i + Scalar::check_scalar(words + i * Layout::kWordBytes, count - i, check, limits);
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
template <typename Layout>
HWY_INLINE size_t take_masks(const uint8_t* words, size_t count, int64_t high_us, const SensorLimits& limits,
                             Columns& columns) {
  Columns to = columns;
  uint32_t last_low = 0;
  size_t i = 0;
  for (; i < count; ++i) {
    const uint32_t head = Layout::head(words + i * Layout::kWordBytes);
    const uint32_t low = low_of(head);
    const uint32_t x = x_of(head);
    if (type_of(head) > kOn || low < last_low || x + 32 > limits.width) break;
    expand_mask(Layout::mask(words + i * Layout::kWordBytes), x, y_of(head), type_of(head), high_us | low, to);
    last_low = low;
  }
  columns.count = to.count;
  return i;
}

template <typename Layout>
size_t decode_words(const uint8_t* words, size_t count, State& state, const SensorLimits& limits, ColumnSink& sink) {
  for (size_t i = 0; i < count;) {
    const uint8_t* word = words + i * Layout::kWordBytes;
    const uint32_t head = Layout::head(word);
    size_t used = 0;
    if (type_of(head) <= kOn && (state.high_us | low_of(head)) >= sink.latest()) {
      Columns out{sink.x, sink.y, sink.p, sink.t, sink.count};
      if constexpr (Layout::kWordBytes == 4) {
        used = take_events(word, count - i, state.high_us, out);
      } else {
        used = take_masks<Layout>(word, count - i, state.high_us, limits, out);
      }
      sink.count = out.count;
    }
    if (used == 0) used = Words<Layout>::decode_scalar(word, 1, state, limits, sink);
    i += used;
  }
  return count;
}

#endif

template <typename Layout>
Kernels kernels_of() {
  return {check_words<Layout>, decode_words<Layout>};
}

Kernels find_kernels(Encoding encoding) {
  switch (encoding) {
    case Encoding::kEvt21Little:
      return kernels_of<Evt21Layout<ByteOrder::kLittle>>();
    case Encoding::kEvt21Legacy:
      return kernels_of<Evt21Layout<ByteOrder::kLegacy>>();
    default:
      return kernels_of<Evt2Layout>();
  }
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

/// Returns the number of invalid words among some.
template <ByteOrder kOrder>
size_t bad_words(std::span<const uint8_t> words) {
  const size_t count = std::min(words.size() / 8, kLookedAt);
  return Words<Evt21Layout<kOrder>>::count_bad(words.data(), count, count);
}

/// Returns the number of valid words before the first invalid one, in steps and up to a limit.
template <ByteOrder kOrder>
size_t good_words(std::span<const uint8_t> words) {
  constexpr size_t kStep = 8;
  const size_t count = std::min(words.size() / 8, kLookedAt);
  size_t good = 0;
  while (good < count) {
    const size_t next = std::min(good + kStep, count);
    if (Words<Evt21Layout<kOrder>>::count_bad(words.data(), next, 1) != 0) break;
    good = next;
  }
  return good;
}

}  // namespace

ByteOrder find_byte_order(std::span<const uint8_t> words, const std::string& hint) {
  size_t little = good_words<ByteOrder::kLittle>(words);
  size_t legacy = good_words<ByteOrder::kLegacy>(words);
  if (little == legacy) {
    // A damaged word ends both counts, whatever the words after it are.
    little = kLookedAt - bad_words<ByteOrder::kLittle>(words);
    legacy = kLookedAt - bad_words<ByteOrder::kLegacy>(words);
  }
  if (little == legacy) return hint == "legacy" ? ByteOrder::kLegacy : ByteOrder::kLittle;
  return little > legacy ? ByteOrder::kLittle : ByteOrder::kLegacy;
}

}  // namespace e2lf::recordings::timed
#endif
