// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/light_field_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/test_log.h"

namespace e2lf::cli {
namespace {

using recon::Verdict;
using testing::HasSubstr;

recon::EventJudgement judgement(Verdict verdict) {
  return {.error = 0.4, .noise_error = 0.2, .ratio = 2.0, .verdict = verdict};
}

std::string warning_of(const Json& cycle) {
  const TestLog log;
  warn_of_verdict(cycle);
  return log.text();
}

TEST(CheckJson, CallsAFavourableVerdictOnDoubtfulTimesUnconfirmed) {
  EXPECT_EQ(check_json(judgement(Verdict::kGood), false)["verdict"], "good");
  EXPECT_EQ(check_json(judgement(Verdict::kGood), true)["verdict"], "unconfirmed");
  EXPECT_EQ(check_json(judgement(Verdict::kUsual), true)["verdict"], "unconfirmed");
  EXPECT_EQ(check_json(judgement(Verdict::kWrong), true)["verdict"], "wrong");
}

TEST(CheckJson, StatesTheChangeAndTheRivalOnlyIfTheyWereTried) {
  auto changed = judgement(Verdict::kChangedBetter);
  changed.change = "with inverted polarity";
  changed.changed_error = 0.1;
  changed.rival_error = 0.3;
  EXPECT_EQ(check_json(changed, false)["changed"]["error"], 0.1);
  EXPECT_EQ(check_json(changed, false)["error_with_the_models_camera"], 0.3);
  const Json plain = check_json(judgement(Verdict::kGood), false);
  EXPECT_FALSE(plain.contains("changed"));
  EXPECT_FALSE(plain.contains("error_with_the_models_camera"));
}

TEST(WarnOfVerdict, NamesTheOptionThatRemediesIt) {
  auto changed = judgement(Verdict::kChangedBetter);
  changed.change = "with inverted polarity";
  EXPECT_THAT(warning_of({{"check", check_json(changed, false)}}), HasSubstr("--invert-polarity"));
  changed.change = "in the order 2, 0, 1";
  EXPECT_THAT(warning_of({{"check", check_json(changed, false)}}), HasSubstr("--first-pattern"));
  EXPECT_THAT(warning_of({{"check", check_json(judgement(Verdict::kWrong), false)}}), HasSubstr("docs/recordings.md"));
  EXPECT_EQ(warning_of({{"check", check_json(judgement(Verdict::kGood), false)}}), "");
  EXPECT_EQ(warning_of(Json::object()), "");
}

TEST(EventErrorText, EndsWithTheVerdict) {
  Json cycle = {{"event_error", 0.4}, {"least_event_error", {{"value", 0.3}, {"residue", 0.0}}}};
  EXPECT_THAT(event_error_text(cycle), HasSubstr("differ from the given ones by 0.400"));
  cycle["least_event_error"]["residue"] = 0.5;
  EXPECT_THAT(event_error_text(cycle), HasSubstr("or by 0.300 if references start 0.50 thresholds above"));
  cycle["check"] = check_json(judgement(Verdict::kUsual), true);
  EXPECT_THAT(event_error_text(cycle), HasSubstr("2.0 times the difference that noise causes: unconfirmed"));
}

}  // namespace
}  // namespace e2lf::cli
