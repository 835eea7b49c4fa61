// SPDX-License-Identifier: MIT
#include "e2lf/events/move_counts.h"

#include <algorithm>

#include "e2lf/base/contract.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/events/move_counts.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace e2lf::events {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void move(int16_t* from, int16_t* to, size_t count) {
  const hn::ScalableTag<int16_t> d;
  size_t i = 0;
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    hn::StoreU(hn::SaturatedAdd(hn::LoadU(d, to + i), hn::LoadU(d, from + i)), d, to + i);
    hn::StoreU(hn::Zero(d), d, from + i);
  }
  for (; i < count; ++i) {
    to[i] = static_cast<int16_t>(std::clamp(to[i] + from[i], -32768, 32767));
    from[i] = 0;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::events
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::events {

HWY_EXPORT(move);

void move_counts(std::span<int16_t> from, std::span<int16_t> to) {
  E2LF_REQUIRE(from.size() == to.size(), "counts of two sizes");
  HWY_DYNAMIC_DISPATCH(move)(from.data(), to.data(), to.size());
}

}  // namespace e2lf::events
#endif
