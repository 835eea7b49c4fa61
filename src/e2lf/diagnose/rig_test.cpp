// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/rig.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

namespace e2lf::diagnose {
namespace {

using cycles::BurstSign;
using cycles::paper_schedule;
using cycles::PatternEvents;
using cycles::plain_schedule;
using cycles::Schedule;

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
  EXPECT_EQ(polarity_of(schedule, usual_events()), Polarity::kRight);
  EXPECT_EQ(polarity_of(schedule, inverted(usual_events())), Polarity::kInverted);
  // Triggers alone do not tell the halves apart, and inverted signs make the wrong half look right.
  EXPECT_EQ(polarity_of(schedule, half_a_cycle_later(inverted(usual_events()))), Polarity::kInverted);
  EXPECT_EQ(polarity_of(schedule, half_a_cycle_later(usual_events())), Polarity::kHalfCycleOff);
}

TEST(Polarity, GoesByTheSignsWhereTheScheduleHasNoInverses) {
  Schedule schedule = plain_schedule(4, 10000);
  const std::vector<PatternEvents> events = {{10, 9000}, {5000, 40}, {900, 500}, {400, 300}};
  EXPECT_EQ(polarity_of(schedule, events), Polarity::kUnknown) << "the schedule states no sign";
  schedule.patterns[0].sign = BurstSign::kOff;
  schedule.patterns[1].sign = BurstSign::kOn;
  EXPECT_EQ(polarity_of(schedule, events), Polarity::kRight);
  EXPECT_EQ(polarity_of(schedule, inverted(events)), Polarity::kInverted);
}

TEST(Polarity, SaysNothingOfFewOrUnsignedEvents) {
  const Schedule schedule = paper_schedule();
  EXPECT_EQ(polarity_of(schedule, std::vector<PatternEvents>(8)), Polarity::kUnknown);
  EXPECT_EQ(polarity_of(schedule, std::vector<PatternEvents>(8, {1000, 1000})), Polarity::kUnknown);
  // Both halves alike, as in recordings that are made of event images.
  auto events = usual_events();
  for (size_t i = 0; i < 4; ++i) events[i] = {events[i + 4].off, events[i + 4].on};
  EXPECT_EQ(polarity_of(schedule, events), Polarity::kUnknown);
}

cycles::Cycle cycle_of(std::vector<PatternEvents> events) {
  cycles::Cycle cycle;
  cycle.pattern_events = std::move(events);
  return cycle;
}

TEST(RigCheck, TrustsNoCycleWhoseSignsContradictTheSchedule) {
  RigCheck rig;
  const cycles::CycleOptions options{.source = cycles::CycleSource::kTriggers};
  EXPECT_EQ(rig.add(cycle_of(usual_events()), options), 1.0F);
  EXPECT_EQ(rig.add(cycle_of(inverted(usual_events())), options), 0.0F);
  EXPECT_EQ(rig.add(cycle_of({}), options), 0.0F) << "the polarity of the last cycle that was read";
  EXPECT_EQ(rig.least_confidence(), 0.0F);
}

TEST(Findings, ComeBackFromJsonAndSpellSettings) {
  const Findings findings = {
      {"polarity-inverted", Severity::kError, "it is inverted", "exchange them", {{"cycles", 3}}, "invert_polarity"}};
  const Findings read = findings_from_text(json_line(to_json(findings)));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].code, "polarity-inverted");
  EXPECT_EQ(read[0].severity, Severity::kError);
  EXPECT_EQ(read[0].figures["cycles"], 3);
  EXPECT_EQ(text_of(read[0]), read[0].code + ": it is inverted; exchange them (invert_polarity)");
  EXPECT_TRUE(findings_from_text("{\"code\": 3}").empty());
  EXPECT_TRUE(has_doubt(read));
}

}  // namespace
}  // namespace e2lf::diagnose
