// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/colour_filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf::capture {
namespace {

TEST(ColourFilter, IsReadRowByRow) {
  EXPECT_THAT(colour_filter_from_name("rggb").value().channels, testing::ElementsAre(0, 1, 1, 2));
  EXPECT_THAT(colour_filter_from_name("gbrg").value().channels, testing::ElementsAre(1, 2, 0, 1));
  for (const char* name : {"", "rgb", "rggg", "rggbb", "rgxb", "RGGB"}) {
    const auto filter = colour_filter_from_name(name);
    ASSERT_FALSE(filter) << name;
    EXPECT_EQ(filter.error().code, ErrorCode::kInvalidValue);
  }
}

TEST(BehindFilter, TakesOnePixelOfEachBlock) {
  EventImages images(2, 2, 4);
  for (size_t i = 0; i < images.values.size(); ++i) images.values[i] = static_cast<int16_t>(i);
  const EventImages part = owned(behind_filter(images, 2));  // lower left
  EXPECT_EQ(part.height, 1U);
  EXPECT_EQ(part.width, 2U);
  EXPECT_THAT(part.values, testing::ElementsAre(4, 6, 12, 14));
  EXPECT_THAT(owned(behind_filter(images, 1)).values, testing::ElementsAre(1, 3, 9, 11));
}

}  // namespace
}  // namespace e2lf::capture
