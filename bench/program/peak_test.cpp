// SPDX-License-Identifier: MIT
#include "bench/program/peak.h"

#include <gtest/gtest.h>

#include "e2lf/engine/conv.h"

namespace e2lf::bench {
namespace {

TEST(Peak, IsMeasuredForEachPrecisionOfTheCpu) {
  const Peak peak = measure_peak();
  EXPECT_GT(peak.float32_flops, 1e9);
  EXPECT_EQ(peak.bfloat16_flops > 0.0, engine::bfloat16_supported());
}

}  // namespace
}  // namespace e2lf::bench
