// SPDX-License-Identifier: MIT
#include "e2lf/base/strided_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>

namespace e2lf {
namespace {

using testing::ElementsAre;
using Image = StridedView<const int, 2>;

/// 0 to 11 in three rows of four.
std::vector<int> twelve() {
  std::vector<int> values(12);
  std::iota(values.begin(), values.end(), 0);
  return values;
}

TEST(StridedView, RowMajorMemoryIsNotCopied) {
  const std::vector<int> memory = twelve();
  const Image image(memory.data(), {3, 4});
  std::vector<int> scratch;
  EXPECT_TRUE(image.is_row_major());
  EXPECT_EQ(image.values(scratch, 5, 3).data(), memory.data() + 5);
  EXPECT_TRUE(scratch.empty());
  EXPECT_EQ(image[1][2], 6);
}

TEST(StridedView, PartsAreInTheOrderOfTheAxes) {
  const std::vector<int> memory = twelve();
  const Image columns(memory.data(), {4, 3}, {1, 4});
  const Image crop(memory.data() + 5, {2, 2}, {4, 1});
  const Image thinned(memory.data(), {2, 2}, {8, 2});
  std::vector<int> scratch;
  EXPECT_THAT(columns.values(scratch), ElementsAre(0, 4, 8, 1, 5, 9, 2, 6, 10, 3, 7, 11));
  EXPECT_THAT(columns.values(scratch, 2, 3), ElementsAre(8, 1, 5));
  EXPECT_THAT(crop.values(scratch), ElementsAre(5, 6, 9, 10));
  EXPECT_THAT(thinned.values(scratch), ElementsAre(0, 2, 8, 10));
  EXPECT_THAT(Image(memory.data(), {3, 4}).reversed(1).values(scratch, 0, 5), ElementsAre(3, 2, 1, 0, 7));
  EXPECT_THAT(Image(memory.data() + 7, {2, 3}, {0, 0}).values(scratch), ElementsAre(7, 7, 7, 7, 7, 7));
  EXPECT_EQ(crop.value(2), 9);
}

TEST(StridedView, ValuesAreVisitedAndCopiedInTheSameOrder) {
  std::vector<int> memory = twelve(), seen;
  const StridedView<int, 2> every_second(memory.data() + 1, {3, 2}, {4, 2});
  for_each_value(every_second, [&](int& value) { seen.push_back(value); });
  EXPECT_THAT(seen, ElementsAre(1, 3, 5, 7, 9, 11));
  const std::vector<int> other = {20, 21, 22, 23, 24, 25};
  copy_values(Image(other.data(), {3, 2}), every_second);
  EXPECT_THAT(memory, ElementsAre(0, 20, 2, 21, 4, 22, 6, 23, 8, 24, 10, 25));
}

}  // namespace
}  // namespace e2lf
