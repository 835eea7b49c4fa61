// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/lightfield/views.h"
#include "testing/test_light_field.h"

namespace e2lf::lightfield {
namespace {

TEST(Crop, TakesTheSameRectangleOfEveryView) {
  const LightField whole = indexed_light_field({2, 3, 5, 7, 3});
  const LightField part = crop(whole, {1, 2, 3, 4}).value();
  EXPECT_EQ(part.shape(), (Shape{2, 3, 3, 4, 3}));
  for (size_t view = 0; view < 6; ++view) {
    for (size_t y = 0; y < 3; ++y) {
      for (size_t x = 0; x < 4; ++x) {
        EXPECT_EQ(part.at(view / 3, view % 3, y, x, 2), whole.at(view / 3, view % 3, y + 1, x + 2, 2));
      }
    }
  }
}

TEST(Crop, RefusesWhatLeavesTheViews) {
  const LightField whole = indexed_light_field({1, 1, 5, 7, 1});
  EXPECT_TRUE(crop(whole, {0, 0, 5, 7}));
  for (const CropRegion& region :
       {CropRegion{0, 0, 6, 7}, {0, 1, 5, 7}, {5, 0, 1, 1}, {0, 0, 0, 3}, {1, 1, SIZE_MAX, 1}}) {
    ASSERT_FALSE(crop(whole, region));
    EXPECT_EQ(crop(whole, region).error().code, ErrorCode::kInvalidValue);
  }
}

TEST(ViewImage, IsTheView) {
  const LightField whole = indexed_light_field({2, 2, 3, 4, 3});
  const Image image = view_image(whole, 1, 0);
  EXPECT_EQ(image.width, 4U);
  EXPECT_EQ(image.height, 3U);
  EXPECT_EQ(image.pixels[(2 * 4 + 1) * 3 + 1], whole.at(1, 0, 2, 1, 1));
  EXPECT_THROW((void)view_image(whole, 2, 0), ContractError);
}

}  // namespace
}  // namespace e2lf::lightfield
