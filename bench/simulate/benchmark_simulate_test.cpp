// SPDX-License-Identifier: MIT
#include "bench/simulate/benchmark_simulate.h"

#include <gtest/gtest.h>

namespace e2lf::bench {
namespace {

TEST(SimulationBenchmark, MeasuresEveryFunction) {
  const auto result = benchmark_simulation({.height = 31, .width = 45, .seconds = 0});
  ASSERT_TRUE(result);
  for (const double rate : {result->intensities_mpx_per_s, result->events_mpx_per_s, result->simulate_mpx_per_s,
                            result->reference_intensities_mpx_per_s, result->reference_events_mpx_per_s,
                            result->reference_simulate_mpx_per_s}) {
    EXPECT_GT(rate, 0);
  }
}

TEST(SimulationBenchmark, UnusableOptionsAreRefused) {
  SimulationBenchmarkOptions options{.height = 4, .width = 4, .seconds = 0};
  options.model.constants.tau = 0;
  EXPECT_EQ(benchmark_simulation(options).error().code, ErrorCode::kInvalidValue);
}

}  // namespace

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
