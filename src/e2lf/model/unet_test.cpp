// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/model/network.h"

namespace e2lf::model {
namespace {

TEST(Unet, IsAValidNetworkWithOneOutputPerView) {
  const Network network = unet({.input_channels = 9});
  const auto shapes = infer_shapes(network);
  ASSERT_TRUE(shapes) << shapes.error().text();
  EXPECT_EQ(shapes->back().channels, 64U);
  EXPECT_EQ(shapes->back().scale, 1U);
  EXPECT_EQ(size_multiple(network), 8U);
}

TEST(Unet, CostsWhatItsConvolutionsAddUpTo) {
  const Network network =
      unet({.input_channels = 3, .output_channels = 5, .widths = {4, 6}, .blocks = {1, 2}, .head_width = 2});
  // stem 12 -> 4, two blocks of 4 (one a side), down 4 -> 6, two blocks of 6, up 6 -> 4, head 4 -> 8, skip, output.
  const size_t stem = 12 * 4 * 9, level0 = 2 * 2 * 4 * 4 * 9, down = 4 * 6 * 4, middle = 2 * 2 * 6 * 6 * 9;
  const size_t up = 6 * 4 * 4, head = 4 * 8 * 9, skip = 3 * 5, output = 2 * 5 * 9;
  const size_t biases = 4 + 4 * 4 + 6 + 4 * 6 + 4 + 8 + 5 + 5;
  EXPECT_EQ(num_parameters(network), stem + level0 + down + middle + up + head + skip + output + biases);
  const double per_pixel = (stem + level0 + head) / 4.0 + (down + middle + up) / 16.0 + skip + output;
  EXPECT_DOUBLE_EQ(macs_per_pixel(network), per_pixel);
}

TEST(Unet, BlocksAtFullResolutionCostTheirConvolutions) {
  const UnetOptions without{.input_channels = 3, .output_channels = 5, .widths = {4}, .blocks = {1}, .head_width = 2};
  UnetOptions with = without;
  with.head_blocks = 2;
  const size_t detail = 3 * 2 * 9, blocks = 2 * 2 * 2 * 2 * 9, biases = 2 + 4 * 2;
  EXPECT_EQ(num_parameters(unet(with)), num_parameters(unet(without)) + detail + blocks + biases);
  EXPECT_DOUBLE_EQ(macs_per_pixel(unet(with)), macs_per_pixel(unet(without)) + detail + blocks);
  EXPECT_EQ(size_multiple(unet(with)), size_multiple(unet(without)));
}

TEST(Unet, WithoutAHeadItCostsNothingAtFullResolution) {
  const Network network =
      unet({.input_channels = 3, .output_channels = 5, .widths = {4, 6}, .blocks = {1, 1}, .head_width = 0});
  const size_t stem = 12 * 4 * 9, level0 = 2 * 2 * 4 * 4 * 9, down = 4 * 6 * 4, middle = 2 * 6 * 6 * 9;
  const size_t up = 6 * 4 * 4, output = 4 * 5 * 4;
  EXPECT_DOUBLE_EQ(macs_per_pixel(network), (stem + level0 + output) / 4.0 + (down + middle + up) / 16.0);
  const auto shapes = infer_shapes(network);
  ASSERT_TRUE(shapes) << shapes.error().text();
  EXPECT_EQ(shapes->back().channels, 5U);
  EXPECT_EQ(shapes->back().scale, 1U);
}

TEST(Unet, BundledSizeFitsItsFileAndCost) {
  const Network network = unet({.input_channels = 9, .head_blocks = 4});
  EXPECT_LT(macs_per_pixel(network), 0.32 * macs_per_pixel(recnet(3)));
  EXPECT_LT(num_parameters(network) * sizeof(float), size_t{8} << 20U);
}

TEST(Unet, UsualSizeIsAtMostAQuarterOfThePapersNetwork) {
  const Network network = unet({.input_channels = 9});
  EXPECT_LT(macs_per_pixel(network), 0.25 * macs_per_pixel(recnet(3)));
  EXPECT_LT(num_parameters(network) * sizeof(float), size_t{8} << 20U);
}

}  // namespace
}  // namespace e2lf::model
