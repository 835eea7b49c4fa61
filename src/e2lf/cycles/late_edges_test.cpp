// SPDX-License-Identifier: MIT
#include "e2lf/cycles/late_edges.h"

#include <gtest/gtest.h>

namespace e2lf::cycles {
namespace {

/// The starts of so many cycles of the paper's schedule, and where it says.
std::vector<PatternStart> starts_of(size_t cycles) {
  const Schedule schedule = paper_schedule();
  std::vector<PatternStart> starts;
  int64_t t_us = 1000;
  for (size_t i = 0; i < cycles * schedule.size(); ++i) {
    starts.push_back({t_us, i % schedule.size()});
    t_us += schedule.patterns[i % schedule.size()].interval_us();
  }
  return starts;
}

std::vector<LateEdge> find(const std::vector<PatternStart>& starts) {
  LateEdgeFinder finder(paper_schedule());
  std::vector<LateEdge> found;
  for (const PatternStart& start : starts) {
    if (const auto late = finder.add(start)) found.push_back(*late);
  }
  return found;
}

TEST(LateEdges, NamesTheOneTriggerThatIsLateOrEarly) {
  for (const int64_t late_us : {500, -300}) {
    for (const size_t edge : {13U, 8U, 23U}) {
      auto starts = starts_of(5);
      starts[edge].t_us += late_us;
      const auto found = find(starts);
      ASSERT_EQ(found.size(), 1U) << edge;
      EXPECT_EQ(found[0].pattern, edge % 8);
      EXPECT_NEAR(static_cast<double>(found[0].late_us), static_cast<double>(late_us), 1);
    }
  }
}

TEST(LateEdges, JitterAndASlowerClockAreNone) {
  auto starts = starts_of(6);
  for (size_t i = 0; i < starts.size(); ++i) {
    starts[i].t_us = static_cast<int64_t>(1.01 * static_cast<double>(starts[i].t_us)) + (i % 3 == 0 ? 40 : -30);
  }
  EXPECT_TRUE(find(starts).empty());
}

TEST(LateEdges, AStepOfEveryCycleIsLearned) {
  auto starts = starts_of(12);
  for (size_t i = 0; i < starts.size(); ++i) starts[i].t_us += i % 8 == 5 ? 400 : 0;
  const auto found = find(starts);
  EXPECT_GE(found.size(), 1U);
  EXPECT_LE(found.size(), 4U);
}

}  // namespace
}  // namespace e2lf::cycles
