// SPDX-License-Identifier: MIT
#include <array>
#include <gtest/gtest.h>

#include "e2lf/lightfield/views.h"
#include "testing/test_light_field.h"

namespace e2lf::lightfield {
namespace {

std::array<float, 3> pixel(const Image& image, size_t y, size_t x) {
  const float* value = image.pixels.data() + (y * image.width + x) * 3;
  return {value[0], value[1], value[2]};
}

bool is_grey(const std::array<float, 3>& colour) {
  return colour[0] == colour[1] && colour[1] == colour[2];
}

TEST(HorizontalEpi, HasARowForEachViewOfTheRow) {
  const LightField light_field = indexed_light_field({2, 3, 4, 5, 3});
  const Image epi = horizontal_epi(light_field, 1, 2);
  ASSERT_EQ(epi.height, 3U);
  ASSERT_EQ(epi.width, 5U);
  EXPECT_EQ(epi.pixels[(2 * 5 + 4) * 3 + 1], light_field.at(1, 2, 2, 4, 1));
  EXPECT_THROW((void)horizontal_epi(light_field, 2, 0), ContractError);
}

TEST(VerticalEpi, HasAColumnForEachViewOfTheColumn) {
  const LightField light_field = indexed_light_field({2, 3, 4, 5, 3});
  const Image epi = vertical_epi(light_field, 2, 1);
  ASSERT_EQ(epi.height, 4U);
  ASSERT_EQ(epi.width, 2U);
  EXPECT_EQ(epi.pixels[(3 * 2 + 1) * 3 + 2], light_field.at(1, 2, 3, 1, 2));
  EXPECT_THROW((void)vertical_epi(light_field, 0, 5), ContractError);
}

TEST(EpiPicture, PutsEpisBelowAndBeside) {
  LightField light_field({2, 4, 8, 9, 1});
  for (size_t view = 0; view < 8; ++view) {
    for (float& value : light_field.view(view / 4, view % 4)) value = 0.1F * static_cast<float>(view);
  }
  EpiPictureOptions options{.view_y = 1, .view_x = 3, .y = 6, .x = 2};
  const Image picture = epi_picture(light_field, options);
  ASSERT_EQ(picture.width, 9U + 4 + 2 * 6);
  ASSERT_EQ(picture.height, 8U + 4 + 4 * 6);
  ASSERT_EQ(picture.channels, 3U);
  EXPECT_FLOAT_EQ(pixel(picture, 0, 0)[1], 0.7F);           // the view (1, 3)
  EXPECT_FALSE(is_grey(pixel(picture, 6, 0)));              // the cut row
  EXPECT_FALSE(is_grey(pixel(picture, 0, 2)));              // the cut column
  EXPECT_FLOAT_EQ(pixel(picture, 12 + 6 + 1, 4)[0], 0.5F);  // below: view (1, 1)
  EXPECT_FLOAT_EQ(pixel(picture, 4, 13 + 2)[0], 0.3F);      // beside: view (0, 3)
  EXPECT_EQ(pixel(picture, 9, 15), (std::array<float, 3>{1, 1, 1}));
}

TEST(EpiPicture, CutsTheMiddleWhenNotTold) {
  const auto options = middle_cut({8, 8, 384, 512, 1});
  EXPECT_EQ(options.view_y, 4U);
  EXPECT_EQ(options.y, 192U);
  EXPECT_EQ(options.x, 256U);
}

}  // namespace
}  // namespace e2lf::lightfield
