// SPDX-License-Identifier: MIT
#include "e2lf/cycles/polarity_check.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

namespace e2lf::cycles {
namespace {

/// What the paper's rig makes of a usual scene, events per 1,000 pixels: white, the inverses, black, a2 to a4.
std::vector<PatternEvents> usual_events() {
  return {{6500, 100}, {20, 630}, {180, 120}, {140, 100}, {50, 12700}, {5200, 30}, {900, 520}, {240, 190}};
}

std::vector<PatternEvents> inverted(std::vector<PatternEvents> events) {
  for (PatternEvents& each : events) std::swap(each.on, each.off);
  return events;
}

std::vector<PatternEvents> half_a_cycle_later(std::vector<PatternEvents> events) {
  std::rotate(events.begin(), events.begin() + 4, events.end());
  return events;
}

TEST(Polarity, TellsInvertedSignsFromTheOtherHalfOfTheCycle) {
  const Schedule schedule = paper_schedule();
  EXPECT_EQ(polarity_of(schedule, usual_events()), CyclePolarity::kRight);
  EXPECT_EQ(polarity_of(schedule, inverted(usual_events())), CyclePolarity::kInverted);
  // Triggers alone do not tell the halves apart, and inverted signs make the wrong half look right.
  EXPECT_EQ(polarity_of(schedule, half_a_cycle_later(inverted(usual_events()))), CyclePolarity::kInverted);
  EXPECT_EQ(polarity_of(schedule, half_a_cycle_later(usual_events())), CyclePolarity::kHalfCycleOff);
}

TEST(Polarity, GoesByTheSignsWhereTheScheduleHasNoInverses) {
  Schedule schedule = plain_schedule(4, 10000);
  const std::vector<PatternEvents> events = {{10, 9000}, {5000, 40}, {900, 500}, {400, 300}};
  EXPECT_EQ(polarity_of(schedule, events), CyclePolarity::kUnknown) << "the schedule states no sign";
  schedule.patterns[0].sign = BurstSign::kOff;
  schedule.patterns[1].sign = BurstSign::kOn;
  EXPECT_EQ(polarity_of(schedule, events), CyclePolarity::kRight);
  EXPECT_EQ(polarity_of(schedule, inverted(events)), CyclePolarity::kInverted);
}

TEST(Polarity, SaysNothingOfFewOrUnsignedEvents) {
  const Schedule schedule = paper_schedule();
  EXPECT_EQ(polarity_of(schedule, std::vector<PatternEvents>(8)), CyclePolarity::kUnknown);
  EXPECT_EQ(polarity_of(schedule, std::vector<PatternEvents>(8, {1000, 1000})), CyclePolarity::kUnknown);
  // Both halves alike, as in recordings that are made of event images.
  auto events = usual_events();
  for (size_t i = 0; i < 4; ++i) events[i] = {events[i + 4].off, events[i + 4].on};
  EXPECT_EQ(polarity_of(schedule, events), CyclePolarity::kUnknown);
}

}  // namespace
}  // namespace e2lf::cycles
