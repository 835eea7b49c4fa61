// SPDX-License-Identifier: MIT
#include "e2lf/base/result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <set>
#include <vector>

#include "e2lf/base/log.h"

namespace e2lf {
namespace {

using testing::HasSubstr;
using testing::Throws;

Error some_error() {
  return {ErrorCode::kShape, "too small; give more", "a.npy"};
}

Result<int> half(int value) {
  if (value % 2 != 0) return some_error();
  return value / 2;
}

Result<int> quarter(int value) {
  E2LF_ASSIGN_OR_RETURN(const int once, half(value));
  E2LF_ASSIGN_OR_RETURN(const int twice, half(once));
  return twice;
}

Result<void> check(int value) {
  E2LF_RETURN_IF_ERROR(quarter(value));
  return {};
}

TEST(Result, HoldsAValueOrAnError) {
  EXPECT_EQ(half(4).value(), 2);
  EXPECT_FALSE(half(3).ok());
  EXPECT_EQ(half(3).error().code, ErrorCode::kShape);
}

TEST(Result, MacrosPassTheFirstErrorOn) {
  EXPECT_EQ(*quarter(8), 2);
  EXPECT_EQ(quarter(6).error().message, "too small; give more");
  EXPECT_TRUE(check(4).ok());
  EXPECT_FALSE(check(6).ok());
}

TEST(Result, AndThenGoesOnWithTheValueOrPassesTheErrorOn) {
  EXPECT_EQ(half(8).and_then(half).and_then(half).value(), 1);
  bool was_called = false;
  const auto after = half(6).and_then(half).and_then([&](int) {
    was_called = true;
    return Result<std::string>("reached");
  });
  EXPECT_EQ(after.error().location, "a.npy");
  EXPECT_FALSE(was_called);
  EXPECT_TRUE(half(8).and_then(check));
  EXPECT_EQ(check(4).and_then([] { return half(4); }).value(), 2);
  EXPECT_EQ(check(6).and_then([] { return half(4); }).error().code, ErrorCode::kShape);
}

TEST(Result, ValueOrIsTheFallbackOnlyOfAnError) {
  EXPECT_EQ(half(4).value_or(7), 2);
  EXPECT_EQ(half(3).value_or(7), 7);
  const Result<std::vector<int>> kept = std::vector<int>{1, 2};
  EXPECT_EQ(kept.value_or({}).size(), 2U);
  EXPECT_EQ(kept->size(), 2U);
}

TEST(Result, MovesWhatCannotBeCopied) {
  Result<std::unique_ptr<int>> result(std::make_unique<int>(5));
  const std::unique_ptr<int> value = *std::move(result);
  EXPECT_EQ(*value, 5);
  const auto next = Result(std::make_unique<int>(6)).and_then([](std::unique_ptr<int> taken) { return half(*taken); });
  EXPECT_EQ(next.value(), 3);
  EXPECT_EQ(*Result(std::make_unique<int>(7)).value_or(nullptr), 7);
}

TEST(Result, AValueTakenFromATemporaryOutlivesIt) {
  const auto numbers = []() -> Result<std::vector<int>> { return std::vector<int>{1, 2, 3}; };
  int sum = 0;
  for (const int number : numbers().value()) sum += number;
  const auto& kept = *numbers();
  EXPECT_EQ(sum, 6);
  EXPECT_EQ(kept.size(), 3U);
}

TEST(Result, ReadingTheOtherOneBreaksTheContract) {
  EXPECT_THROW((void)half(3).value(), ContractError);
  EXPECT_THROW((void)half(4).error(), ContractError);
  EXPECT_THROW(check(6).value(), ContractError);
  EXPECT_THROW((void)check(4).error(), ContractError);
}

TEST(Error, TextPutsTheLocationFirst) {
  EXPECT_EQ(some_error().text(), "a.npy: too small; give more");
  EXPECT_EQ((Error{ErrorCode::kIo, "full; free space", ""}).text(), "full; free space");
}

TEST(Error, EveryCodeHasItsOwnName) {
  std::set<std::string> names;
  for (int code = 0; code <= static_cast<int>(ErrorCode::kInternal); ++code) {
    names.insert(error_code_name(static_cast<ErrorCode>(code)));
  }
  EXPECT_EQ(names.size(), static_cast<size_t>(ErrorCode::kInternal) + 1);
  EXPECT_STREQ(error_code_name(ErrorCode::kNotFound), "not_found");
}

TEST(Contract, SaysWhereAndWhat) {
  const int sides = 2;
  try {
    E2LF_REQUIRE(sides == 3, "a triangle");
    FAIL() << "the contract held";
  } catch (const ContractError& error) {
    EXPECT_THAT(error.what(), HasSubstr("result_test.cpp"));
    EXPECT_THAT(error.what(), HasSubstr("sides == 3"));
    EXPECT_THAT(error.what(), HasSubstr("a triangle"));
  }
}

TEST(Log, GoesToTheSinkAndIsSilentWithoutOne) {
  std::vector<std::pair<LogLevel, std::string>> seen;
  log_warning("before");
  const LogSink previous =
      set_log_sink([&](LogLevel level, const std::string& text) { seen.emplace_back(level, text); });
  log_info("b");
  log_warning("c");
  set_log_sink(previous);
  log_warning("after");
  using Entry = std::pair<LogLevel, std::string>;
  EXPECT_THAT(seen, testing::ElementsAre(Entry{LogLevel::kInfo, "b"}, Entry{LogLevel::kWarning, "c"}));
}

}  // namespace
}  // namespace e2lf
