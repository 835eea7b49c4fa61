// SPDX-License-Identifier: MIT
#include "e2lf/recordings/count_on.h"

#include <numeric>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/recordings/count_on.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace e2lf::recordings {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

uint64_t sum(const uint8_t* bytes, size_t count) {
  uint64_t total = 0;
  size_t i = 0;
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  const hn::ScalableTag<uint8_t> d;
  const hn::Repartition<uint64_t, decltype(d)> d64;
  const size_t lanes = hn::Lanes(d);
  auto first = hn::Zero(d64), second = hn::Zero(d64);
  for (; i + 2 * lanes <= count; i += 2 * lanes) {
    first = hn::Add(first, hn::SumsOf8(hn::LoadU(d, bytes + i)));
    second = hn::Add(second, hn::SumsOf8(hn::LoadU(d, bytes + i + lanes)));
  }
  total = hn::GetLane(hn::SumOfLanes(d64, hn::Add(first, second)));
#endif
  return std::accumulate(bytes + i, bytes + count, total);
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::recordings
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::recordings {

HWY_EXPORT(sum);

uint64_t count_on(std::span<const uint8_t> p) {
  return HWY_DYNAMIC_DISPATCH(sum)(p.data(), p.size());
}

}  // namespace e2lf::recordings
#endif
