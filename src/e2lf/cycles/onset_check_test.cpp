// SPDX-License-Identifier: MIT
#include "e2lf/cycles/onset_check.h"

#include <gtest/gtest.h>

namespace e2lf::cycles {
namespace {

/// Bursts every 10 ms that set in at once and fade within 3 ms, a little noise between them, and starts that are said
/// to be `late_us` after the bursts.
OnsetCheck bursts(int64_t late_us, size_t events_per_burst = 2000) {
  OnsetCheck check;
  std::vector<int64_t> times_us;
  for (int64_t burst = 1; burst < 40; ++burst) {
    const int64_t begin_us = 10'000 * burst;
    for (int64_t t_us = begin_us - 7'000; t_us < begin_us; t_us += 70) times_us.push_back(t_us);
    for (size_t i = 0; i < events_per_burst; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(events_per_burst);
      times_us.push_back(begin_us + static_cast<int64_t>(3000 * share * share));
    }
    check.add_start(begin_us + late_us);
  }
  check.add_events(times_us);
  return check;
}

TEST(OnsetCheck, B4EventsSetInWithTheirTrigger) {
  const auto onset_us = bursts(0).onset_us();
  ASSERT_TRUE(onset_us);
  EXPECT_NEAR(*onset_us, 0, 100);
}

TEST(OnsetCheck, B4TriggersThatAreAllLateByTheSameTimeAreMeasured) {
  for (const int64_t late_us : {500, 1000, 3000, -800}) {
    const auto onset_us = bursts(late_us).onset_us();
    ASSERT_TRUE(onset_us) << late_us;
    EXPECT_NEAR(*onset_us, -late_us, 100) << late_us;
  }
}

TEST(OnsetCheck, FewEventsAndFewStartsSayNothing) {
  OnsetCheck check;
  for (int64_t start = 1; start < 20; ++start) {
    check.add_start(10'000 * start);
    check.add_events(std::vector<int64_t>{10'000 * start + 100, 10'000 * start + 200});
  }
  EXPECT_FALSE(check.onset_us());
  EXPECT_FALSE(OnsetCheck().onset_us());
}

TEST(OnsetCheck, StartsWithoutRelationToTheEventsSayNothing) {
  OnsetCheck check;
  std::vector<int64_t> times_us;
  for (int64_t burst = 1; burst < 60; ++burst) {
    for (int64_t i = 0; i < 2000; ++i) times_us.push_back(10'000 * burst + i);
    check.add_start(8'700 * burst);
  }
  check.add_events(times_us);
  EXPECT_FALSE(check.onset_us());
}

}  // namespace
}  // namespace e2lf::cycles
