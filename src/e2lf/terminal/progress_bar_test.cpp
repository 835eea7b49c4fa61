// SPDX-License-Identifier: MIT
#include "e2lf/terminal/progress_bar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf {
namespace {

using testing::HasSubstr;

TEST(ProgressLine, ShowsShareAndRemainingTime) {
  EXPECT_EQ(progress_line("reconstruct", 1, 2, 3.0),
            "reconstruct  [" + std::string(15, '#') + std::string(15, '.') + "] 50 %  3 s left");
  EXPECT_THAT(progress_line("x", 1, 10, 10.0), HasSubstr("1 min 30 s left"));
  EXPECT_THAT(progress_line("x", 1, 101, 72.6), HasSubstr("2 h 1 min left"));
}

}  // namespace
}  // namespace e2lf
