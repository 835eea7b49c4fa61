// SPDX-License-Identifier: MIT
#include "e2lf/terminal/progress_bar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ProgressLine, ShowsShareAndRemainingTime) {
  EXPECT_EQ(progress_line("reconstruct", 1, 2, 3.0),
            "reconstruct  [" + std::string(15, '#') + std::string(15, '.') + "] 50 %  3 s left");
  EXPECT_THAT(progress_line("x", 1, 10, 10.0), HasSubstr("1 min 30 s left"));
  EXPECT_THAT(progress_line("x", 1, 101, 72.6), HasSubstr("2 h 1 min left"));
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

TEST(ProgressBar, LogsALineOfATenthAtMostEvery20Seconds) {
  EXPECT_FALSE(is_line_due(0, 0, 1e6)) << "nothing is new";
  EXPECT_FALSE(is_line_due(3, 2, 19));
  EXPECT_TRUE(is_line_due(3, 2, 20));
  EXPECT_TRUE(is_line_due(9, 2, 20));
}

}  // namespace
}  // namespace e2lf
