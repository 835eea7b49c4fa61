// SPDX-License-Identifier: MIT
#include "e2lf/program/verb.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/test_files.h"

namespace e2lf::program {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Runs a verb with one number and one list, and returns its exit code.
struct TestVerb {
  Verb verb{"try", "tries flags.", "e2lf try"};
  double tau = 0.3;
  std::vector<std::string> names;

  TestVerb() {
    verb.app().add_option("--tau", tau);
    verb.app().add_option("--name", names);
    verb.app().add_flag("--tau-s");
  }
  int run(const std::vector<std::string>& arguments, const Result<void>& outcome = {}) {
    return verb.run(arguments, [&] { return outcome; });
  }
};

TEST(Verb, SpellsOptionsInErrorsAsItsFlags) {
  const auto printed = [](const char* option) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(TestVerb().run({}, Error{ErrorCode::kInvalidValue, "too low", "y", option}), 1);
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(printed("tau_s"), "e2lf: try: y: too low (--tau-s)\n");
  EXPECT_EQ(printed("sigma"), "e2lf: try: y: too low\n");  // this verb does not have it
  EXPECT_EQ(printed(""), "e2lf: try: y: too low\n");
  EXPECT_EQ((Error{ErrorCode::kInvalidValue, "too low", "", "tau_s"}.text()), "too low (tau_s)");
}

TEST(FlagsFromConfig, ConvertsEveryKindOfValue) {
  TestVerb test;
  CLI::App& app = test.verb.app();
  bool flip_x = false;
  app.add_flag("--flip-x", flip_x);
  const auto flags = [&](const char* text) { return flags_from_config(Json::parse(text), app, "c.json"); };
  EXPECT_THAT(flags(R"({"tau": 0.25})").value(), ElementsAre("--tau=0.25"));
  EXPECT_THAT(flags(R"({"name": ["a", "b"]})").value(), ElementsAre("--name=a", "--name=b"));
  EXPECT_THAT(flags(R"({"flip_x": true})").value(), ElementsAre("--flip-x"));
  EXPECT_THAT(flags(R"({"flip-x": false})").value(), ElementsAre());
}

TEST(FlagsFromConfig, SuggestsTheNearestKey) {
  TestVerb test;
  const auto flags = flags_from_config({{"tua", 1}}, test.verb.app(), "c.json");
  ASSERT_FALSE(flags);
  EXPECT_EQ(flags.error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(flags.error().location, "c.json");
  EXPECT_THAT(flags.error().message, HasSubstr("tau"));
  EXPECT_EQ(flags_from_config(Json::array(), test.verb.app(), "c.json").error().code, ErrorCode::kFormat);
}

TEST(Verb, PrefersTheCommandLineToTheConfiguration) {
  const TestFolder folder;
  std::ofstream(folder / "c.json") << R"({"tau": 0.5, "name": "a"})";
  TestVerb test;
  EXPECT_EQ(test.run({"--config", (folder / "c.json").string(), "--tau", "0.7"}), 0);
  EXPECT_EQ(test.tau, 0.7);
  EXPECT_THAT(test.names, ElementsAre("a"));
  TestVerb set;
  EXPECT_EQ(set.run({"--config", (folder / "c.json").string(), "--set", "tau=0.6"}), 0);
  EXPECT_EQ(set.tau, 0.6);
}

TEST(Verb, NamesTheRunForTheRecordOfACycle) {
  const TestFolder folder;
  std::ofstream(folder / "run.json") << R"({"cycle": {"number": 2}, "notes": {}, "written_by": "e2lf"})";
  testing::internal::CaptureStderr();
  EXPECT_EQ(TestVerb().run({"--config", folder.path().string()}), 2);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("give the folder above it"));
}

TEST(ShellWord, WritesAPathThatIsNoOption) {
  EXPECT_EQ(shell_word(std::filesystem::path("-out")), "./-out");
  EXPECT_EQ(shell_word(std::filesystem::path("-an out")), "'./-an out'");
  EXPECT_EQ(shell_word(std::filesystem::path("-")), "-");
  EXPECT_EQ(shell_word(std::string("-m")), "-m");
}

TEST(Verb, ReturnsTheExitCodeOfTheOutcome) {
  EXPECT_EQ(TestVerb().run({}), 0);
  EXPECT_EQ(TestVerb().run({}, Error{ErrorCode::kIo, "the disk is full; free some space", "a"}), 1);
  EXPECT_EQ(TestVerb().run({"--no-such-flag"}), 2);
  EXPECT_EQ(TestVerb().run({"--tau", "nan"}), 2);
  EXPECT_EQ(TestVerb().run({"--seed", "-1"}), 2);
  TestVerb live;
  live.verb.set_failed_input("the camera was unplugged");
  EXPECT_EQ(live.run({}), 3);
}

TEST(Verb, RefusesOptionsWithoutEffect) {
  TestVerb test;
  test.verb.app().get_option("--tau")->group("Streams");
  ASSERT_EQ(test.run({"--tau", "0.5"}), 0);
  EXPECT_FALSE(test.verb.refuse_options({"Streams"}, "a light field"));
  EXPECT_TRUE(test.verb.refuse_options({"Cycles"}, "a light field"));
}

}  // namespace
}  // namespace e2lf::program
