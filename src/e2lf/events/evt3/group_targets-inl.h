// SPDX-License-Identifier: MIT
// Where groups of EVT3 words go: columns, or cells that go to images. Included once for each target.
#if defined(E2LF_EVENTS_EVT3_GROUP_TARGETS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_EVT3_GROUP_TARGETS_INL_H
#undef E2LF_EVENTS_EVT3_GROUP_TARGETS_INL_H
#else
#define E2LF_EVENTS_EVT3_GROUP_TARGETS_INL_H
#endif

#include <algorithm>
#include <bit>

#include <hwy/highway.h>

#include "e2lf/events/evt3/lane_groups-inl.h"
#include "e2lf/events/raw/expand-inl.h"
#include "e2lf/events/raw/sinks.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::events::evt3 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_AVX3_DL

using events::HWY_NAMESPACE::add_mask_to_row;
using events::HWY_NAMESPACE::Columns;
using events::HWY_NAMESPACE::expand_mask;

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

  [[nodiscard]] static bool is_open() { return true; }
  [[nodiscard]] static int64_t end_us() { return INT64_MAX; }

  /// What follows is at times with these high bits.
  void begin(int64_t high_us) {
    high_us_ = high_us;
    out_ = {sink_.x, sink_.y, sink_.p, sink_.t, sink_.count};
  }
  void end() { sink_.count = out_.count; }
  void make_room() {}

  /// Takes the lanes of a group that `events` has; polarity is in bit 11 of the word.
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

/// Images, by way of some cells (a pixel or 32 of them), so that their pixels can be brought near before they are
/// counted.
class ToImages {
 public:
  explicit ToImages(ImageSink& sink) : sink_(sink) {}

  [[nodiscard]] bool is_open() const { return sink_.is_open() && sink_.image() != nullptr; }
  [[nodiscard]] int64_t end_us() const { return sink_.slice_end_us(); }

  void begin(int64_t high_us) { high_us_ = high_us; }
  void end() { count_cells(); }
  void make_room() {
    if (count_ > kMax) count_cells();
  }

  void put_events(hn::Vec<Group> word, hn::Vec<Group> x, hn::Vec<Group> y, hn::Vec<Group> low, uint32_t events) {
    const Group d;
    const auto chosen = hn::Load(GroupBytes(), kLaneTables.compress[events]);
    const auto place = hn::Or(x, hn::And(hn::ShiftLeft<4>(word), hn::Set(d, uint16_t{kP})));
    hn::StoreU(lanes_from(place, chosen), d, place_ + count_);
    hn::StoreU(lanes_from(y, chosen), d, y_ + count_);
    hn::StoreU(lanes_from(low, chosen), d, low_ + count_);
    count_ += static_cast<size_t>(std::popcount(events));
  }

  void put_vector(uint32_t mask, uint32_t x, uint32_t y, uint32_t p, uint32_t low) {
    if (count_ > kMax) count_cells();
    place_[count_] = static_cast<uint16_t>(x | kMany | (p != 0 ? kP : 0));
    y_[count_] = static_cast<uint16_t>(y);
    low_[count_] = static_cast<uint16_t>(low);
    mask_[count_] = mask;
    count_ += mask != 0 ? 1 : 0;
  }

 private:
  static constexpr size_t kMax = 192, kAhead = 32;
  static constexpr uint32_t kX = 0xFFF;      ///< x, in place_
  static constexpr uint32_t kMany = 0x4000;  ///< set when mask_ tells which of the pixels from x on
  static constexpr uint32_t kP = 0x8000;     ///< polarity

  void count_cells() {
    if (count_ == 0) return;
    uint64_t all = 0, on = 0;
    prefetch(0, std::min(kAhead, count_));
    for (size_t begin = 0; begin < count_; begin += kAhead) {
      const size_t end = std::min(begin + kAhead, count_);
      prefetch(end, std::min(end + kAhead, count_));
      for (size_t i = begin; i < end; i += kGroupWords) add_group(i, std::min(end, i + kGroupWords), all, on);
    }
    sink_.note_events(on, all - on, high_us_ | low_[0], high_us_ | low_[count_ - 1]);
    count_ = 0;
  }

  /// Counts at most eight cells; groups of single pixels need no look at each.
  void add_group(size_t begin, size_t end, uint64_t& all, uint64_t& on) {
    const auto place = hn::Load(SignedGroup(), reinterpret_cast<const int16_t*>(place_ + begin));
    const auto is_many = hn::BroadcastSignBit(hn::ShiftLeft<1>(place));
    const uint32_t many_on =
        bits_of_two(hn::BitCast(Group(), is_many), hn::BitCast(Group(), hn::BroadcastSignBit(place)));
    if (end == begin + kGroupWords && (many_on & 0xFF) == 0) {
      for (size_t i = begin; i < begin + kGroupWords; ++i) {
        ImageSink::bump(pixel_of(i), place_[i] >= kP ? 1 : -1);
      }
      all += kGroupWords;
      on += static_cast<uint64_t>(std::popcount(many_on));
      return;
    }
    for (size_t i = begin; i < end; ++i) {
      const uint64_t events = add(i);
      all += events;
      on += place_[i] >= kP ? events : 0;
    }
  }

  [[nodiscard]] int16_t& pixel_of(size_t i) const { return sink_.image()[y_[i] * sink_.width() + (place_[i] & kX)]; }

  void prefetch(size_t begin, size_t end) const {
    for (size_t i = begin; i < end; ++i) {
      sink_.prefetch_pixel(place_[i] & kX, y_[i]);
      if ((place_[i] & kMany) != 0) sink_.prefetch_pixel((place_[i] & kX) + 31, y_[i]);
    }
  }

  /// Counts the pixels of a cell; returns how many.
  uint64_t add(size_t i) {
    const uint32_t x = place_[i] & kX;
    int16_t* const pixel = &pixel_of(i);
    const int step = place_[i] >= kP ? 1 : -1;
    if ((place_[i] & kMany) == 0) {
      ImageSink::bump(*pixel, step);
      return 1;
    }
    uint32_t mask = mask_[i];
    const auto events = static_cast<uint64_t>(std::popcount(mask));
    if (x + 32 <= sink_.width()) {
      add_mask_to_row(mask, step, pixel);
    } else {
      for (; mask != 0; mask &= mask - 1) ImageSink::bump(pixel[std::countr_zero(mask)], step);
    }
    return events;
  }

  ImageSink& sink_;
  int64_t high_us_ = 0;
  size_t count_ = 0;
  alignas(16) uint16_t place_[kMax + 16];
  alignas(16) uint16_t y_[kMax + 16];
  alignas(16) uint16_t low_[kMax + 16];
  alignas(16) uint32_t mask_[kMax + 16];
};

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::events::evt3
HWY_AFTER_NAMESPACE();

#endif
