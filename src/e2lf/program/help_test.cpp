// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "e2lf/program/options.h"
#include "e2lf/program/verb.h"

namespace e2lf::program {
namespace {

using testing::AllOf, testing::ElementsAre, testing::HasSubstr, testing::Not;

/// A verb with two options of its own that are always shown, and 16 of cameras.
struct VerbWithManyOptions {
  Verb verb{"test", "A test.", "e2lf test"};
  std::string values[18];

  VerbWithManyOptions() {
    verb.app().add_option("--seen", values[0], "a usual option");
    {
      const OptionGroup group(verb.app(), kCameraOptions);
      for (int i = 1; i < 17; ++i) verb.app().add_option(cat("--setting-", i), values[i], "a setting");
    }
    verb.app().add_option("--also-seen", values[17], "another usual option");
  }
  int run(const std::vector<std::string>& arguments) {
    return verb.run(arguments, [] { return Result<void>(); });
  }
};

TEST(Help, ShowsUsualOptionsAndTheNamesOfGroups) {
  VerbWithManyOptions many;
  EXPECT_THAT(short_help(many.verb.app()),
              AllOf(HasSubstr("--seen"), HasSubstr("--also-seen"), HasSubstr("--help=cameras"), HasSubstr("e2lf test"),
                    Not(HasSubstr("--setting-1")), Not(HasSubstr("--seed"))));
  EXPECT_THAT(help_groups(many.verb.app()), ElementsAre("run", "cameras"));
}

TEST(Help, ShowsOneGroupOrAll) {
  VerbWithManyOptions many;
  const auto cameras = group_help(many.verb.app(), "cameras");
  ASSERT_TRUE(cameras);
  EXPECT_THAT(*cameras, AllOf(HasSubstr("--setting-1"), HasSubstr("--setting-16"), Not(HasSubstr("--seen"))));
  EXPECT_FALSE(group_help(many.verb.app(), "camera"));
  EXPECT_FALSE(group_help(many.verb.app(), ""));
  EXPECT_THAT(whole_help(many.verb.app()),
              AllOf(HasSubstr("--setting-16"), HasSubstr("--seen"), HasSubstr("--seed"), HasSubstr("e2lf test")));
  EXPECT_EQ(many.run({"--help=cameras"}), 0);
  EXPECT_EQ(VerbWithManyOptions().run({"--help-all"}), 0);
  EXPECT_EQ(VerbWithManyOptions().run({"--help=kameras"}), 2);
}

TEST(Help, ShowsEverythingOfVerbsWithFewOptions) {
  Verb few("few", "A test.", "e2lf few");
  EXPECT_EQ(short_help(few.app()), whole_help(few.app()));
  EXPECT_THAT(short_help(few.app()), HasSubstr("--seed"));
}

}  // namespace
}  // namespace e2lf::program
