// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/triggers.h"

#include <gmock/gmock.h>

namespace e2lf::diagnose {
namespace {

using cycles::paper_schedule;
using cycles::Schedule;
using testing::HasSubstr;

/// Triggers of the paper's schedule, `scale` times as slow, from the middle of a cycle on: a rising edge at each
/// pattern and a falling one 500 us later.
std::vector<recordings::Trigger> triggers_of(const Schedule& schedule, double scale = 1.0, uint16_t id = 0,
                                             size_t count = 60) {
  std::vector<recordings::Trigger> triggers;
  double t_us = 5000;
  for (size_t i = 3; i < 3 + count; ++i) {
    triggers.push_back({static_cast<int64_t>(t_us), id, 1});
    triggers.push_back({static_cast<int64_t>(t_us) + 500, id, 0});
    t_us += scale * static_cast<double>(schedule.patterns[i % schedule.size()].interval_us());
  }
  return triggers;
}

/// Returns the code of the finding, or nothing.
std::string code_for(const std::vector<recordings::Trigger>& triggers, cycles::CycleOptions options = {},
                     int64_t silence_us = 0) {
  TriggerInputs inputs;
  add(triggers, inputs);
  const auto found = check_triggers(inputs, options, triggers.empty() ? 0 : triggers.back().t + silence_us);
  return found ? found->code : "";
}

template <typename Keep>
std::vector<recordings::Trigger> kept(const std::vector<recordings::Trigger>& triggers, Keep keep) {
  std::vector<recordings::Trigger> result;
  for (size_t i = 0; i < triggers.size(); ++i) {
    if (keep(i)) result.push_back(triggers[i]);
  }
  return result;
}

TEST(CheckTriggers, FindsNothingWhereTheTriggersMatchTheSchedule) {
  EXPECT_EQ(code_for(triggers_of(paper_schedule())), "");
  EXPECT_EQ(code_for(triggers_of(paper_schedule(), 1.05)), "");
}

TEST(CheckTriggers, NamesTheEdgeAndTheChannel) {
  const auto triggers = triggers_of(paper_schedule());
  EXPECT_EQ(code_for(kept(triggers, [](size_t i) { return i % 2 == 1; })), "trigger-edge");
  EXPECT_EQ(code_for(triggers, {.edge = cycles::TriggerEdge::kBoth}), "trigger-edge");
  auto both = triggers;
  for (const auto& other : triggers_of(paper_schedule(), 0.13, 3)) both.push_back(other);
  TriggerInputs inputs;
  add(both, inputs);
  EXPECT_EQ(check_triggers(inputs, {}, 0)->option, "channel");
  EXPECT_THAT(check_triggers(inputs, {}, 0)->remedy, HasSubstr("channel 0"));
  EXPECT_EQ(code_for(triggers, {.channel = uint16_t{7}}), "trigger-channel");
}

TEST(CheckTriggers, DistinguishesTriggersOfCyclesAndOfPatterns) {
  const auto triggers = triggers_of(paper_schedule(), 1.0, 0, 160);
  EXPECT_EQ(code_for(kept(triggers, [](size_t i) { return i % 16 < 2; })), "triggers-of-cycles");
  EXPECT_EQ(code_for(kept(triggers, [](size_t i) { return i < 64 && i % 16 < 2; })), "triggers-of-cycles") << "only 4";
  EXPECT_EQ(code_for(triggers, {.one_trigger_per_cycle = true}), "triggers-of-patterns");
  const auto two = kept(triggers, [](size_t i) { return i < 32 && i % 16 < 2; });
  EXPECT_EQ(code_for(two), "triggers-few");
  EXPECT_EQ(code_for(two, {.one_trigger_per_cycle = true}), "");
}

TEST(CheckTriggers, DistinguishesOtherSchedulesFromMissingTriggers) {
  EXPECT_EQ(code_for(triggers_of(paper_schedule(), 1.5)), "schedule-scaled");
  EXPECT_EQ(code_for(triggers_of(paper_schedule(), 0.5)), "schedule-scaled");
  EXPECT_EQ(code_for(triggers_of(paper_schedule(6))), "schedule-other");
  const auto triggers = triggers_of(paper_schedule());
  EXPECT_EQ(code_for(kept(triggers, [](size_t i) { return i % 4 < 2; })), "triggers-halved");
  // Each trigger has two edges; the 5th, 11th, 12th, 20th ... are lost.
  const auto some = kept(triggers, [](size_t i) {
    const size_t trigger = i / 2 % 20;
    return trigger != 5 && trigger != 11 && trigger != 12;
  });
  TriggerInputs inputs;
  add(some, inputs);
  const auto missing = check_triggers(inputs, {}, some.back().t);
  ASSERT_TRUE(missing);
  EXPECT_EQ(missing->code, "triggers-missing");
  EXPECT_EQ(missing->figures["missing"], 9);
}

TEST(CheckTriggers, CountsAdditionalOnes) {
  for (const int64_t after_us : {40, 4000}) {
    std::vector<recordings::Trigger> bouncing;
    size_t rising = 0;
    for (const recordings::Trigger& trigger : triggers_of(paper_schedule())) {
      bouncing.push_back(trigger);
      if (trigger.p != 0 && ++rising % 17 == 0) bouncing.push_back({trigger.t + after_us, 0, 1});
    }
    TriggerInputs inputs;
    add(bouncing, inputs);
    const auto extra = check_triggers(inputs, {}, bouncing.back().t);
    ASSERT_TRUE(extra) << after_us;
    EXPECT_EQ(extra->code, "triggers-extra");
    EXPECT_EQ(extra->severity, Severity::kWarning);
    EXPECT_EQ(extra->figures["extra"], inputs.at(0).rising.count - 60);
  }
}

TEST(CheckTriggers, CountsBouncesOfEachTrigger) {
  std::vector<recordings::Trigger> bouncing;
  for (const recordings::Trigger& trigger : triggers_of(paper_schedule())) {
    for (const int64_t after_us : {0, 60, 200}) bouncing.push_back({trigger.t + after_us, trigger.id, trigger.p});
  }
  TriggerInputs inputs;
  add(bouncing, inputs);
  const auto extra = check_triggers(inputs, {}, bouncing.back().t);
  ASSERT_TRUE(extra);
  EXPECT_EQ(extra->code, "triggers-extra");
  EXPECT_EQ(extra->figures["extra"], inputs.at(0).rising.count / 3 * 2);
  EXPECT_EQ(code_for(bouncing, {.edge = cycles::TriggerEdge::kBoth}), "trigger-edge");
}

TEST(CheckTriggers, AcceptsALineThatTogglesIfBothEdgesAreUsed) {
  std::vector<recordings::Trigger> toggling = kept(triggers_of(paper_schedule()), [](size_t i) { return i % 2 == 0; });
  for (size_t i = 1; i < toggling.size(); i += 2) toggling[i].p = 0;
  EXPECT_EQ(code_for(toggling, {.edge = cycles::TriggerEdge::kBoth}), "");
  EXPECT_EQ(code_for(toggling), "triggers-halved");
}

TEST(CheckTriggers, FindsTheirAbsenceAndTheirEnd) {
  EXPECT_EQ(code_for({}), "triggers-absent");
  const auto triggers = triggers_of(paper_schedule());
  EXPECT_EQ(code_for(triggers, {}, 500000), "triggers-end");
  TriggerInputs inputs;
  add(triggers, inputs);
  EXPECT_THAT(triggers_text(inputs, paper_schedule()), HasSubstr("channel 0 has 60 rising and 60 falling edges"));
  EXPECT_THAT(triggers_text(inputs, paper_schedule()), HasSubstr("expects 8 in 94.74 ms, mostly 10.59 ms apart"));
}

/// Returns cycles of the paper's schedule whose triggers are shifted by shift(trigger), in us.
template <typename Shift>
std::vector<LateTrigger> late_triggers(size_t cycles, double scale, Shift shift) {
  const Schedule schedule = paper_schedule();
  std::vector<cycles::PatternStart> starts;
  double t_us = 1000;
  for (size_t i = 0; i <= cycles * schedule.size(); ++i) {
    starts.push_back({static_cast<int64_t>(t_us) + shift(i), i % schedule.size()});
    t_us += scale * static_cast<double>(schedule.patterns[i % schedule.size()].interval_us());
  }
  LateTriggerFinder finder;
  std::vector<LateTrigger> late;
  for (size_t c = 0; c < cycles; ++c) {
    const auto begin = starts.begin() + static_cast<ptrdiff_t>(c * schedule.size());
    cycles::Cycle cycle;
    cycle.number = c;
    cycle.starts.assign(begin, begin + static_cast<ptrdiff_t>(schedule.size()));
    cycle.end_us = (begin + static_cast<ptrdiff_t>(schedule.size()))->t_us;
    for (const LateTrigger& each : finder.add(cycle, schedule)) late.push_back(each);
  }
  return late;
}

TEST(LateTriggers, NamesTheOneTriggerThatIsLateOrEarly) {
  for (const int64_t late_us : {500, -300}) {
    for (const size_t trigger : {13U, 8U, 23U}) {
      const auto late = late_triggers(5, 1, [&](size_t i) { return i == trigger ? late_us : 0; });
      ASSERT_EQ(late.size(), 1U) << trigger;
      EXPECT_EQ(late[0].cycle, trigger / 8);
      EXPECT_EQ(late[0].pattern, trigger % 8);
      EXPECT_NEAR(static_cast<double>(late[0].late_us), static_cast<double>(late_us), 1);
    }
  }
}

TEST(LateTriggers, JitterASlowerClockAndAStepOfEveryCycleAreNone) {
  EXPECT_TRUE(late_triggers(6, 1.01, [](size_t i) { return i % 3 == 0 ? 40 : -30; }).empty());
  EXPECT_LE(late_triggers(12, 1, [](size_t i) { return i % 8 == 5 ? 400 : 0; }).size(), 4U);
}

}  // namespace
}  // namespace e2lf::diagnose
