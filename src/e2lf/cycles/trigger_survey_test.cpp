// SPDX-License-Identifier: MIT
#include "e2lf/cycles/trigger_survey.h"

#include <gmock/gmock.h>

namespace e2lf::cycles {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

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

std::string advice_for(const std::vector<recordings::Trigger>& triggers, const SurveyOptions& options = {},
                       const Schedule& schedule = paper_schedule()) {
  TriggerSurvey survey;
  survey.add(triggers);
  return trigger_advice(survey, schedule, options, triggers.empty() ? 0 : triggers.back().t);
}

template <typename Keep>
std::vector<recordings::Trigger> kept(const std::vector<recordings::Trigger>& triggers, Keep keep) {
  std::vector<recordings::Trigger> result;
  for (size_t i = 0; i < triggers.size(); ++i) {
    if (keep(i)) result.push_back(triggers[i]);
  }
  return result;
}

TEST(TriggerAdvice, IsEmptyWhereTheTriggersFitTheSchedule) {
  EXPECT_THAT(advice_for(triggers_of(paper_schedule())), IsEmpty());
  EXPECT_THAT(advice_for(triggers_of(paper_schedule(), 1.05)), IsEmpty());
}

TEST(TriggerAdvice, NamesTheEdgeAndTheChannel) {
  const auto triggers = triggers_of(paper_schedule());
  const auto falling = kept(triggers, [](size_t i) { return i % 2 == 1; });
  EXPECT_THAT(advice_for(falling), HasSubstr("--edge falling"));
  EXPECT_THAT(advice_for(triggers, {.takes_rising = true, .takes_falling = true}), HasSubstr("--edge rising"));
  auto both = triggers;
  for (const auto& other : triggers_of(paper_schedule(), 0.13, 3)) both.push_back(other);
  EXPECT_THAT(advice_for(both), HasSubstr("--channel 0"));
  EXPECT_THAT(advice_for(triggers, {.has_channel = true, .channel = 7}), HasSubstr("--channel 0"));
}

TEST(TriggerAdvice, NamesOneTriggerPerCycle) {
  const auto triggers = triggers_of(paper_schedule(), 1.0, 0, 160);
  EXPECT_THAT(advice_for(kept(triggers, [](size_t i) { return i % 16 < 2; })), HasSubstr("--one-trigger-per-cycle"));
  EXPECT_THAT(advice_for(triggers, {.one_trigger_per_cycle = true}), HasSubstr("leave the option out"));
}

TEST(TriggerAdvice, TellsSlowerSchedulesOtherPatternsAndMissingEdgesApart) {
  EXPECT_THAT(advice_for(triggers_of(paper_schedule(), 1.5)), HasSubstr("1.5 times as long"));
  EXPECT_THAT(advice_for(triggers_of(paper_schedule(), 0.5)), HasSubstr("0.5 times as long"));
  EXPECT_THAT(advice_for(triggers_of(paper_schedule(6))), HasSubstr("--patterns 6"));
  const auto triggers = triggers_of(paper_schedule());
  EXPECT_THAT(advice_for(kept(triggers, [](size_t i) { return i % 4 < 2; })), HasSubstr("every second trigger"));
  auto bouncing = triggers;
  for (const auto& trigger : triggers) {
    if (trigger.p != 0) bouncing.push_back({trigger.t + 1200, trigger.id, 1});
  }
  std::ranges::sort(bouncing, {}, &recordings::Trigger::t);
  EXPECT_THAT(advice_for(bouncing), HasSubstr("bounces"));
}

TEST(TriggerAdvice, CountsMissingTriggers) {
  // Each trigger has two edges; the 5th, 11th, 12th, 20th ... are lost.
  const auto some = kept(triggers_of(paper_schedule()), [](size_t i) {
    const size_t trigger = i / 2 % 20;
    return trigger != 5 && trigger != 11 && trigger != 12;
  });
  EXPECT_THAT(advice_for(some), HasSubstr("9 of 60 triggers are missing"));
}

TEST(TriggerAdvice, SaysThatThereAreNoneOrThatTheyEnd) {
  EXPECT_THAT(advice_for({}), HasSubstr("no triggers"));
  TriggerSurvey survey;
  const auto triggers = triggers_of(paper_schedule());
  survey.add(triggers);
  EXPECT_THAT(trigger_advice(survey, paper_schedule(), {}, triggers.back().t + 500000), HasSubstr("the triggers end"));
  EXPECT_THAT(survey_text(survey, paper_schedule()), HasSubstr("channel 0 has 60 rising and 60 falling edges"));
  EXPECT_THAT(survey_text(survey, paper_schedule()), HasSubstr("expects 8 in 94.74 ms, mostly 10.59 ms apart"));
}

}  // namespace
}  // namespace e2lf::cycles
