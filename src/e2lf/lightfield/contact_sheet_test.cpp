// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/lightfield/views.h"

namespace e2lf::lightfield {
namespace {

TEST(Shrink, AveragesWholeAndFractionalPixels) {
  Image image(3, 2, 1);
  image.pixels = {1, 2, 3, /**/ 3, 4, 5};
  const Image small = shrink(image, 2, 1);
  // Column 0 covers pixel 0 and half of pixel 1.
  ASSERT_EQ(small.pixels.size(), 2U);
  EXPECT_FLOAT_EQ(small.pixels[0], (2 + 0.5F * 3) / 1.5F);
  EXPECT_FLOAT_EQ(small.pixels[1], (0.5F * 3 + 4) / 1.5F);
  EXPECT_EQ(shrink(image, 3, 2), image);
}

TEST(Shrink, KeepsChannelsApart) {
  Image image(2, 1, 3);
  image.pixels = {0, 1, 0.5F, 1, 0, 0.5F};
  EXPECT_EQ(shrink(image, 1, 1).pixels, (std::vector<float>{0.5F, 0.5F, 0.5F}));
  image.pixels = {0.5F, 0, 1, 0.5F, 0, 1};
  EXPECT_EQ(shrink(image, 1, 1).pixels, (std::vector<float>{0.5F, 0, 1}));
}

TEST(Shrink, RefusesToEnlarge) {
  EXPECT_THROW((void)shrink(Image(3, 3, 1), 4, 3), ContractError);
}

TEST(ContactSheet, PutsViewsInTheOrderOfTheAperture) {
  LightField light_field({2, 3, 4, 5, 1});
  for (size_t view = 0; view < 6; ++view) {
    for (float& value : light_field.view(view / 3, view % 3)) value = 0.1F * static_cast<float>(view);
  }
  const Image sheet = contact_sheet(light_field, 100);
  ASSERT_EQ(sheet.width, 19U);
  ASSERT_EQ(sheet.height, 10U);
  for (size_t view = 0; view < 6; ++view) {
    EXPECT_FLOAT_EQ(sheet.pixels[(view / 3 * 6 + 3) * 19 + view % 3 * 7 + 4], 0.1F * static_cast<float>(view));
  }
  EXPECT_EQ(sheet.pixels[5], 1.0F);
  EXPECT_EQ(sheet.pixels[4 * 19], 1.0F);
}

TEST(ContactSheet, FitsTheWidth) {
  const LightField light_field({8, 8, 30, 40, 3});
  const Image sheet = contact_sheet(light_field, 174);
  EXPECT_EQ(sheet.width, 174U);
  EXPECT_EQ(sheet.height, 8U * 15 + 7 * 2);
  EXPECT_THROW((void)contact_sheet(light_field, 21), ContractError);
}

}  // namespace
}  // namespace e2lf::lightfield
