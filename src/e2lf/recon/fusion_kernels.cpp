// SPDX-License-Identifier: MIT
#include "e2lf/recon/fusion_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/recon/fusion_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace e2lf::recon::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kShift = 6;
static_assert(capture::kFusedUnits == 1U << kShift);

template <class D, class V = hn::Vec<D>>
V Limited(D d, V counts) {
  return hn::Min(hn::Max(counts, hn::Set(d, units_of(INT16_MIN) >> kShift)), hn::Set(d, units_of(INT16_MAX) >> kShift));
}

void BlockResiduals(const TwoRows& counts, const TwoRows& means, size_t width, int32_t* HWY_RESTRICT sums) {
  size_t x = 0;
#if HWY_TARGET != HWY_SCALAR  // which has no pairs
  const hn::ScalableTag<int16_t> d16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  const auto sum_pairs = [&](auto of_16_bits) {  // the lower count of each pair is in the low half of 32 bits
    const auto v = hn::BitCast(d32, of_16_bits);
    return hn::Add(hn::ShiftRight<16>(hn::ShiftLeft<16>(v)), hn::ShiftRight<16>(v));
  };
  for (; x + hn::Lanes(d16) <= width; x += hn::Lanes(d16)) {
    const auto newest =
        hn::Add(Limited(d16, hn::LoadU(d16, counts[0] + x)), Limited(d16, hn::LoadU(d16, counts[1] + x)));
    const auto mean = hn::Add(sum_pairs(hn::LoadU(d16, means[0] + x)), sum_pairs(hn::LoadU(d16, means[1] + x)));
    hn::StoreU(hn::Sub(hn::ShiftLeft<kShift>(sum_pairs(newest)), mean), d32, sums + x / kBlock);
    for (size_t row = 0; row < kBlock;
         ++row) {  // the next blocks, without which most of the time is waiting for memory
      __builtin_prefetch(counts[row] + x + kBlock * width);
      __builtin_prefetch(means[row] + x + kBlock * width);
    }
  }
#endif
  for (; x < width; x += kBlock) {
    int32_t sum = 0;
    for (size_t row = 0; row < kBlock; ++row) {
      for (size_t at = x; at < std::min(x + kBlock, width); ++at) sum += units_of(counts[row][at]) - means[row][at];
    }
    sums[x / kBlock] = sum;
  }
}

void AddToMeans(const int16_t* HWY_RESTRICT counts, const int16_t* HWY_RESTRICT weights, size_t width,
                int16_t* HWY_RESTRICT means) {
  const hn::ScalableTag<int16_t> d;
  const auto whole = hn::Set(d, kWholeWeight);
  size_t x = 0;
  for (; x + hn::Lanes(d) <= width; x += hn::Lanes(d)) {
    const auto newest = hn::ShiftLeft<kShift>(Limited(d, hn::LoadU(d, counts + x)));
    const auto mean = hn::LoadU(d, means + x), weight = hn::LoadU(d, weights + x);
    const auto moved = hn::Add(mean, hn::MulFixedPoint15(hn::SaturatedSub(newest, mean), weight));
    hn::StoreU(hn::IfThenElse(hn::Eq(weight, whole), newest, moved), d, means + x);
  }
  for (; x < width; ++x) {
    const int16_t newest = units_of(counts[x]);
    const int difference = std::clamp(newest - means[x], INT16_MIN, INT16_MAX);
    const int moved = means[x] + ((difference * weights[x] + (1 << 14)) >> 15);
    means[x] = weights[x] == kWholeWeight ? newest : static_cast<int16_t>(moved);
  }
}

void AddSquares(const int32_t* HWY_RESTRICT residuals, size_t cells, float* HWY_RESTRICT of_blocks,
                float* HWY_RESTRICT sums) {
  for (size_t x = 0; x < cells; ++x) {
    const auto left = static_cast<float>(residuals[2 * x]), right = static_cast<float>(residuals[2 * x + 1]);
    of_blocks[x] += left * left + right * right;
    sums[x] += left + right;
  }
}

void SumRows(std::span<const float* const> rows, size_t count, float* HWY_RESTRICT sums) {
  const hn::ScalableTag<float> d;
  size_t x = 0;
  for (; x + hn::Lanes(d) <= count; x += hn::Lanes(d)) {
    auto sum = hn::LoadU(d, rows[0] + x);
    for (size_t i = 1; i < rows.size(); ++i) sum = hn::Add(sum, hn::LoadU(d, rows[i] + x));
    hn::StoreU(sum, d, sums + x);
  }
  for (; x < count; ++x) {
    sums[x] = rows[0][x];
    for (size_t i = 1; i < rows.size(); ++i) sums[x] += rows[i][x];
  }
}

}  // namespace e2lf::recon::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::recon {

HWY_EXPORT(BlockResiduals);
HWY_EXPORT(AddToMeans);
HWY_EXPORT(AddSquares);
HWY_EXPORT(SumRows);

void block_residuals(const TwoRows& counts, const TwoRows& means, size_t width, int32_t* sums) {
  HWY_DYNAMIC_DISPATCH(BlockResiduals)(counts, means, width, sums);
}

void add_to_means(const int16_t* counts, const int16_t* weights, size_t width, int16_t* means) {
  HWY_DYNAMIC_DISPATCH(AddToMeans)(counts, weights, width, means);
}

void add_squares(const int32_t* residuals, size_t cells, float* of_blocks, float* sums) {
  HWY_DYNAMIC_DISPATCH(AddSquares)(residuals, cells, of_blocks, sums);
}

void sum_rows(std::span<const float* const> rows, size_t count, float* sums) {
  HWY_DYNAMIC_DISPATCH(SumRows)(rows, count, sums);
}

}  // namespace e2lf::recon
#endif
