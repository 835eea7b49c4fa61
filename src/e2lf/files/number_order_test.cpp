// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

#include "e2lf/files/file.h"

namespace e2lf {
namespace {

TEST(NumberOrder, CountsNumbersInNames) {
  const std::vector<std::filesystem::path> ordered = {
      "-10",  "-2",        "-1",         "0",        "1",        "01",      "2",           "10",          "a-1", "a-2",
      "a-10", "bag_2.db3", "bag_10.db3", "cycle_-2", "cycle_-1", "cycle_0", "cycle_00007", "cycle_00010", "x"};
  std::vector<std::filesystem::path> sorted = ordered;
  std::ranges::reverse(sorted);
  std::ranges::sort(sorted, is_before_in_number_order);
  // "1" and "01" are the same number, in the order of their characters.
  std::vector<std::filesystem::path> expected = ordered;
  std::swap(expected[4], expected[5]);
  EXPECT_EQ(sorted, expected);
  EXPECT_FALSE(is_before_in_number_order("a_1", "a_1"));
}

}  // namespace
}  // namespace e2lf
