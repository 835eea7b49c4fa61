// SPDX-License-Identifier: MIT
#include "e2lf/depth/disparity_picture.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

namespace e2lf::depth {
namespace {

using lightfield::Image;

/// Returns the part of a picture to the right of a column, in grey.
Image right_of(const Image& picture, size_t column) {
  const Image grey = lightfield::to_grey(picture);
  Image part(grey.width - column, grey.height, 1);
  for (size_t i = 0; i < part.pixels.size(); ++i) {
    part.pixels[i] = grey.pixels[i / part.width * grey.width + column + i % part.width];
  }
  return part;
}

TEST(ColourPicture, IsLighterForNearerPoints) {
  Image disparity(101, 1, 1);
  for (size_t i = 0; i < 101; ++i) disparity.pixels[i] = 1 - 0.02F * static_cast<float>(i);
  const Image grey = lightfield::to_grey(colour_picture(disparity, {-1, 1}));
  for (size_t i = 1; i < 101; ++i) EXPECT_GT(grey.pixels[i], grey.pixels[i - 1]) << i;
}

TEST(ColourPicture, IsGreyWhereNothingIsKnown) {
  Image disparity(1, 1, 1);
  disparity.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(colour_picture(disparity, {-1, 1}).pixels, (std::vector<float>{0.5F, 0.5F, 0.5F}));
}

TEST(Text, IsInkWithinItsPicture) {
  const Image small = text_picture("-1.57 near", 16), large = text_picture("-1.57 near", 64);
  EXPECT_EQ(small.height, 16U);
  EXPECT_NEAR(4.0 * static_cast<double>(small.width), static_cast<double>(large.width), 4);
  // Ink of the letters, and none on the border, where it would be clipped.
  EXPECT_LT(*std::min_element(large.pixels.begin(), large.pixels.end()), 0.05F);
  for (size_t x = 0; x < large.width; ++x) {
    EXPECT_GT(large.pixels[x], 0.95F) << x;
    EXPECT_GT(large.pixels[63 * large.width + x], 0.95F) << x;
  }
  EXPECT_NE(text_picture("1", 16), text_picture("7", 16));
  EXPECT_THROW((void)text_picture("q", 16), ContractError);
}

TEST(Legend, StandsBesideThePicture) {
  const Image disparity(40, 300, 1);
  const DisparityRange range{-1.25F, 2};
  const Image plain = colour_picture(disparity, range), picture = picture_with_scale(disparity, range);
  ASSERT_EQ(picture.height, 300U);
  EXPECT_TRUE(std::equal(plain.pixels.begin(), plain.pixels.begin() + 120, picture.pixels.begin()));
  const Image legend = right_of(picture, 47);
  const size_t top = 21, bottom = top + 271;              // of the bar
  EXPECT_GT(legend.pixels[top * legend.width], 0.8F);     // near is yellow
  EXPECT_LT(legend.pixels[bottom * legend.width], 0.2F);  // far is dark violet
  for (size_t y = 0; y < legend.height; ++y) EXPECT_EQ(legend.pixels[(y + 1) * legend.width - 1], 1) << "clipped " << y;
}

TEST(Legend, IsWholeBesideASmallPicture) {
  const Image picture = picture_with_scale(Image(8, 5, 1), {-10.25F, -10});
  EXPECT_EQ(picture.height, 4 * 14U);
  const Image legend = right_of(picture, 8);
  for (size_t y = 0; y < legend.height; ++y) EXPECT_EQ(legend.pixels[(y + 1) * legend.width - 1], 1) << "clipped " << y;
}

TEST(ShownRange, LeavesOutWhatIsUncertain) {
  Image disparity(200, 1, 1), confidence(200, 1, 1);
  for (size_t i = 0; i < 200; ++i) {
    disparity.pixels[i] = i < 20 ? 9 : 0.01F * static_cast<float>(i);
    confidence.pixels[i] = i < 20 ? 0.04F : kLeastConfidence;
  }
  EXPECT_NEAR(shown_range(disparity, confidence).least, 0.21F, 1e-6);
  EXPECT_NEAR(shown_range(disparity, confidence).most, 1.98F, 1e-6);
  confidence.pixels.assign(200, 0);
  EXPECT_EQ(shown_range(disparity, confidence).most, 9);
}

}  // namespace
}  // namespace e2lf::depth
