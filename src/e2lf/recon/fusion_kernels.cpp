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

void AddResiduals(const int16_t* HWY_RESTRICT counts, const int16_t* HWY_RESTRICT means, size_t width,
                  int32_t* HWY_RESTRICT sums) {
  size_t x = 0;
#if HWY_TARGET != HWY_SCALAR  // which has no pairs
  const hn::ScalableTag<int16_t> d16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  for (; x + hn::Lanes(d16) <= width; x += hn::Lanes(d16)) {
    // In 32 bits, the lower count of each pair is in the low half.
    const auto pairs = hn::BitCast(d32, Limited(d16, hn::LoadU(d16, counts + x)));
    const auto of_means = hn::BitCast(d32, hn::LoadU(d16, means + x));
    const auto sum_pairs = [](auto v) {
      return hn::Add(hn::ShiftRight<16>(hn::ShiftLeft<16>(v)), hn::ShiftRight<16>(v));
    };
    const auto residual = hn::Sub(hn::ShiftLeft<kShift>(sum_pairs(pairs)), sum_pairs(of_means));
    hn::StoreU(hn::Add(hn::LoadU(d32, sums + x / kBlock), residual), d32, sums + x / kBlock);
  }
#endif
  for (; x < width; ++x) sums[x / kBlock] += units_of(counts[x]) - means[x];
}

void AddToMeans(const int16_t* HWY_RESTRICT counts, const int32_t* HWY_RESTRICT weights, size_t width,
                int16_t* HWY_RESTRICT means) {
  const hn::ScalableTag<int32_t> d;
  const hn::Rebind<int16_t, decltype(d)> d16;
  const auto half = hn::Set(d, 1 << (kMeanWeightBits - 1));
  size_t x = 0;
  for (; x + hn::Lanes(d) <= width; x += hn::Lanes(d)) {
    const auto newest = hn::ShiftLeft<kShift>(Limited(d, hn::PromoteTo(d, hn::LoadU(d16, counts + x))));
    const auto mean = hn::PromoteTo(d, hn::LoadU(d16, means + x));
    const auto step = hn::Add(hn::Mul(hn::Sub(newest, mean), hn::LoadU(d, weights + x)), half);
    hn::StoreU(hn::DemoteTo(d16, hn::Add(mean, hn::ShiftRight<kMeanWeightBits>(step))), d16, means + x);
  }
  for (; x < width; ++x) {
    const int step = (units_of(counts[x]) - means[x]) * weights[x] + (1 << (kMeanWeightBits - 1));
    means[x] = static_cast<int16_t>(means[x] + (step >> kMeanWeightBits));
  }
}

}  // namespace e2lf::recon::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::recon {

HWY_EXPORT(AddResiduals);
HWY_EXPORT(AddToMeans);

void add_residuals(const int16_t* counts, const int16_t* means, size_t width, int32_t* sums) {
  HWY_DYNAMIC_DISPATCH(AddResiduals)(counts, means, width, sums);
}

void add_to_means(const int16_t* counts, const int32_t* weights, size_t width, int16_t* means) {
  HWY_DYNAMIC_DISPATCH(AddToMeans)(counts, weights, width, means);
}

}  // namespace e2lf::recon
#endif
