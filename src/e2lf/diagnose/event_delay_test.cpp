// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/diagnose/triggers.h"

namespace e2lf::diagnose {
namespace {

/// Bursts every 10 ms that set in at once and fade within 3 ms, a little noise between them, and starts that are said
/// to be `late_us` after the bursts.
EventDelay bursts(int64_t late_us, size_t events_per_burst = 2000) {
  EventDelay check;
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

TEST(EventDelay, B4EventsSetInWithTheirTrigger) {
  const auto delay_us = bursts(0).delay_us();
  ASSERT_TRUE(delay_us);
  EXPECT_NEAR(*delay_us, 0, 100);
}

TEST(EventDelay, B4TriggersThatAreAllLateByTheSameTimeAreMeasured) {
  for (const int64_t late_us : {500, 1000, 3000, -800}) {
    const auto delay_us = bursts(late_us).delay_us();
    ASSERT_TRUE(delay_us) << late_us;
    EXPECT_NEAR(*delay_us, -late_us, 100) << late_us;
  }
}

TEST(EventDelay, FewEventsAndFewStartsSayNothing) {
  EventDelay check;
  for (int64_t start = 1; start < 20; ++start) {
    check.add_start(10'000 * start);
    check.add_events(std::vector<int64_t>{10'000 * start + 100, 10'000 * start + 200});
  }
  EXPECT_FALSE(check.delay_us());
  EXPECT_FALSE(EventDelay().delay_us());
}

TEST(EventDelay, StartsWithoutRelationToTheEventsSayNothing) {
  EventDelay check;
  std::vector<int64_t> times_us;
  for (int64_t burst = 1; burst < 60; ++burst) {
    for (int64_t i = 0; i < 2000; ++i) times_us.push_back(10'000 * burst + i);
    check.add_start(8'700 * burst);
  }
  check.add_events(times_us);
  EXPECT_FALSE(check.delay_us());
}

}  // namespace
}  // namespace e2lf::diagnose
