// SPDX-License-Identifier: MIT
// The destination of groups of EVT3 words: columns. Included once for each target.
#if defined(E2LF_EVENTS_EVT3_GROUP_TARGETS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_EVT3_GROUP_TARGETS_INL_H
#undef E2LF_EVENTS_EVT3_GROUP_TARGETS_INL_H
#else
#define E2LF_EVENTS_EVT3_GROUP_TARGETS_INL_H
#endif

#include <algorithm>
#include <bit>

#include <hwy/highway.h>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/lane_groups-inl.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/expand-inl.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/word_codec.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings::evt3 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_AVX3_DL

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

/// The columns of a sink.
class ToColumns {
 public:
  explicit ToColumns(ColumnSink& sink) : sink_(sink) {}

  /// Sets the high bits of the times that follow.
  void begin(int64_t high_us) {
    high_us_ = high_us;
    out_ = {sink_.x, sink_.y, sink_.p, sink_.t, sink_.count};
  }
  void end() { sink_.count = out_.count; }

  /// Appends the lanes of a group that are set in `events`; the polarity is bit 11 of the word.
  void put_events(hn::Vec<Group> word, hn::Vec<Group> x, hn::Vec<Group> y, hn::Vec<Group> low, uint32_t events) {
    const Group d;
    const SignedGroup di;
    const hn::Half<GroupBytes> d8;
    const auto chosen = hn::Load(GroupBytes(), kLaneTables.compress[events]);
    const auto polarity = hn::And(hn::ShiftRight<11>(word), hn::Set(d, uint16_t{1}));
    const Columns to = out_;
    hn::StoreU(lanes_from(x, chosen), d, to.x + to.count);
    hn::StoreU(lanes_from(y, chosen), d, to.y + to.count);
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(di, lanes_from(polarity, chosen))), d8, to.p + to.count);
    store_times(lanes_from(low, chosen), high_us_, to.t + to.count);
    out_.count += static_cast<size_t>(std::popcount(events));
  }

  void put_vector(uint32_t mask, uint32_t x, uint32_t y, uint32_t p, uint32_t low) {
    expand_mask<32>(mask, x, y, p, high_us_ | low, out_);
  }

 private:
  ColumnSink& sink_;
  Columns out_{};
  int64_t high_us_ = 0;
};

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings::evt3
HWY_AFTER_NAMESPACE();

#endif
