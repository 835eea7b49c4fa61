// SPDX-License-Identifier: MIT
#include "e2lf/base/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(Text, JoinsAndDescribesShapes) {
  EXPECT_EQ(cat("view ", 3, " of ", 1.5), "view 3 of 1.5");
  EXPECT_EQ(join({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(join({"a", "b"}, "/"), "a/b");
  EXPECT_EQ(join({}), "");
  EXPECT_EQ(shape_text({3, 720, 1280}), "[3, 720, 1280]");
  EXPECT_EQ(shape_text({}), "[]");
}

TEST(Text, JoinKeepsEmptyParts) {
  EXPECT_EQ(join({"", "b", ""}), ", b, ");
}

TEST(Suggestion, IsTheWordThatATypingMistakeMissed) {
  const std::vector<std::string> words = {"batch", "steps", "rate"};
  EXPECT_EQ(suggestion("bacth", words), "did you mean \"batch\"?");
  EXPECT_EQ(suggestion("step", words), "did you mean \"steps\"?");
  EXPECT_EQ(suggestion("--step", {"--steps"}, ""), "did you mean --steps?");
  EXPECT_EQ(suggestion("recon", {"demo", "reconstruct", "resume"}), "did you mean \"reconstruct\"?");
}

TEST(Suggestion, NamesAllWhereNoneIsNear) {
  EXPECT_EQ(suggestion("learning_rate", {"batch", "steps"}), "known are batch, steps");
  EXPECT_EQ(suggestion("", {"batch", "steps"}), "known are batch, steps");
  EXPECT_EQ(suggestion("x", {}), "there are none");
  const std::string many = suggestion("learning", std::vector<std::string>(20, "steps"));
  EXPECT_TRUE(many.ends_with("steps, ...")) << many;
}

TEST(ProgressLine, LeavesTheTimeOutWhenItIsNotKnown) {
  EXPECT_THAT(progress_line("x", 0, 10, 5.0), Not(HasSubstr("left")));
  EXPECT_THAT(progress_line("x", 5, 10, 0.1), Not(HasSubstr("left")));
  EXPECT_THAT(progress_line("x", 10, 10, 5.0), testing::EndsWith("100 %"));
  EXPECT_THAT(progress_line("x", 12, 10, 5.0), HasSubstr("100 %"));
}

TEST(ProgressLine, CountsWhereTheTotalIsNotKnown) {
  EXPECT_EQ(progress_line("convert", 1200, 0, 3.4, "events"), "convert  1200 events  3 s");
}

TEST(ProgressBar, IsSilentWhenQuietOrNotATerminal) {
  testing::internal::CaptureStderr();
  {
    ProgressBar bar("work");
    bar.callback()(1, 2);
    ProgressBar quiet("work", /*quiet=*/true);
    quiet.update(1, 2);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace e2lf
