// SPDX-License-Identifier: MIT
#include "bench/simulate/benchmark_stream.h"

#include <gtest/gtest.h>

namespace e2lf::bench {
namespace {

TEST(StreamBenchmark, MeasuresFastAndReference) {
  const auto result = benchmark_stream({}, 31, 45);
  ASSERT_TRUE(result);
  EXPECT_GT(result->events, 31U * 45U);
  for (const double rate : {result->events_per_s, result->one_thread_events_per_s, result->reference_events_per_s}) {
    EXPECT_GT(rate, 0);
  }
}

TEST(StreamBenchmark, UnusableOptionsAreRefused) {
  streams::StreamOptions options;
  options.constants.tau = 0;
  EXPECT_EQ(benchmark_stream(options, 4, 4).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::bench
