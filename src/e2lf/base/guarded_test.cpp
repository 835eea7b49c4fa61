// SPDX-License-Identifier: MIT
#include "e2lf/base/guarded.h"

#include <gtest/gtest.h>
#include <new>

namespace e2lf {
namespace {

TEST(Guarded, ReturnsWhatTheWorkReturns) {
  EXPECT_EQ(guarded([]() -> Result<int> { return 3; }).value(), 3);
  EXPECT_TRUE(guarded([] {}).ok());
  const auto failed = guarded([]() -> Result<void> { return fail(ErrorCode::kShape, "place", "too small"); });
  EXPECT_EQ(failed.error().code, ErrorCode::kShape);
}

TEST(Guarded, TurnsExceptionsIntoErrors) {
  const auto broken = guarded([] { E2LF_REQUIRE(false, "a contract"); });
  EXPECT_EQ(broken.error().code, ErrorCode::kInternal);
  EXPECT_NE(broken.error().message.find("a contract"), std::string::npos);
  EXPECT_EQ(guarded([]() -> Result<int> { throw std::bad_alloc(); }).error().code, ErrorCode::kInternal);
  EXPECT_EQ(guarded([] { throw 1; }).error().code, ErrorCode::kInternal);  // NOLINT: of an unknown kind
}

TEST(Guarded, AThreadReportsItsErrorAndThenEnds) {
  std::string order;
  guarded_thread(
      [&] {
        order += "work ";
        throw std::bad_alloc();
      },
      [&](const Error& error) { order += error.code == ErrorCode::kInternal ? "error " : "other "; },
      [&] { order += "end"; })
      .join();
  EXPECT_EQ(order, "work error end");
}

}  // namespace
}  // namespace e2lf
