// SPDX-License-Identifier: MIT
// Included once per instruction set.
#if defined(E2LF_EVENTS_RAW_EXPAND_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_EVENTS_RAW_EXPAND_INL_H
#undef E2LF_EVENTS_RAW_EXPAND_INL_H
#else
#define E2LF_EVENTS_RAW_EXPAND_INL_H
#endif

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128

/// The columns of a sink, by value so that they stay in registers.
struct Columns {
  uint16_t* HWY_RESTRICT x;
  uint16_t* HWY_RESTRICT y;
  uint8_t* HWY_RESTRICT p;
  int64_t* HWY_RESTRICT t;
  size_t count;
};

/// Number of pixels of a mask.
constexpr size_t kMaskBits = 32;

template <typename D>
HWY_INLINE hn::Mask<D> mask_of(D d, uint32_t bits) {
  alignas(8) uint8_t bytes[8] = {};
  std::memcpy(bytes, &bits, sizeof(bits));
  return hn::LoadMaskBits(d, bytes);
}

#if HWY_TARGET == HWY_AVX3_DL

/// Appends an event at base_x + i for each set bit i < kMaskBits. Writes up to as many elements from columns.count on.
HWY_INLINE void expand_mask(uint32_t mask, uint32_t base_x, uint32_t y, uint32_t p, int64_t t, Columns& columns) {
  const hn::CappedTag<uint16_t, kMaskBits> d16;
  const hn::CappedTag<uint8_t, kMaskBits> d8;
  const hn::CappedTag<int64_t, 8> d64;
  const Columns to = columns;
  const auto xs = hn::Iota(d16, static_cast<uint16_t>(base_x));
  hn::StoreU(hn::Compress(xs, mask_of(d16, mask)), d16, to.x + to.count);
  hn::StoreU(hn::Set(d16, static_cast<uint16_t>(y)), d16, to.y + to.count);
  hn::StoreU(hn::Set(d8, static_cast<uint8_t>(p)), d8, to.p + to.count);
  const auto ts = hn::Set(d64, t);
  for (size_t i = 0; i < kMaskBits; i += 8) hn::StoreU(ts, d64, to.t + to.count + i);
  columns.count += static_cast<size_t>(std::popcount(mask));
}

#else

/// The positions of the set bits of a byte.
struct BitPositions {
  alignas(16) uint16_t of[256][8];
};
inline constexpr BitPositions kBitPositions = [] {
  BitPositions positions{};
  for (uint32_t byte = 0; byte < 256; ++byte) {
    size_t count = 0;
    for (uint16_t bit = 0; bit < 8; ++bit) {
      if (((byte >> bit) & 1) != 0) positions.of[byte][count++] = bit;
    }
  }
  return positions;
}();

/// Writes the same y, p and t 16 times.
HWY_INLINE void store_same(uint16_t* HWY_RESTRICT to_y, uint8_t* HWY_RESTRICT to_p, int64_t* HWY_RESTRICT to_t,
                           uint32_t y, uint32_t p, int64_t t) {
  const hn::CappedTag<uint16_t, 16> d16;
  const hn::CappedTag<uint8_t, 16> d8;
  const hn::CappedTag<int64_t, 8> d64;
  const auto ys = hn::Set(d16, static_cast<uint16_t>(y));
  const auto ts = hn::Set(d64, t);
  for (size_t i = 0; i < 16; i += hn::Lanes(d16)) hn::StoreU(ys, d16, to_y + i);
  hn::StoreU(hn::Set(d8, static_cast<uint8_t>(p)), d8, to_p);
  for (size_t i = 0; i < 16; i += hn::Lanes(d64)) hn::StoreU(ts, d64, to_t + i);
}

HWY_INLINE void expand_mask(uint32_t mask, uint32_t base_x, uint32_t y, uint32_t p, int64_t t, Columns& columns) {
  const hn::CappedTag<uint16_t, 8> d16;
  const Columns to = columns;
  size_t count = to.count;
  for (uint32_t begin = 0; begin < kMaskBits; begin += 8) {
    const uint32_t part = (mask >> begin) & 0xFF;
    const auto base = hn::Set(d16, static_cast<uint16_t>(base_x + begin));
    hn::StoreU(hn::Add(hn::Load(d16, kBitPositions.of[part]), base), d16, to.x + count);
    count += static_cast<size_t>(std::popcount(part));
  }
  store_same(to.y + to.count, to.p + to.count, to.t + to.count, y, p, t);
  if (count > to.count + 16) {
    store_same(to.y + to.count + 16, to.p + to.count + 16, to.t + to.count + 16, y, p, t);
  }
  columns.count = count;
}

#endif

#endif

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings
HWY_AFTER_NAMESPACE();

#endif
