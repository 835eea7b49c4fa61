// SPDX-License-Identifier: MIT
#include "e2lf/depth/disparity_error.h"

#include <gtest/gtest.h>
#include <limits>

namespace e2lf::depth {
namespace {

using lightfield::Image;

Image ramp(size_t width, size_t height) {
  Image image(width, height, 1);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.01F * static_cast<float>(i % width);
  return image;
}

TEST(DisparityError, OfATrueMapIsZeroWithSlopeOne) {
  const Image truth = ramp(50, 40);
  const auto error = compare(truth, {}, truth);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->bad_07_percent, 0);
  EXPECT_EQ(error->bad_20_percent, 0);
  EXPECT_EQ(error->mean_absolute_px, 0);
  EXPECT_NEAR(error->slope, 1, 1e-9);
  EXPECT_EQ(error->num_pixels, 20U * 10U);
  EXPECT_TRUE(error->most_certain.empty());
}

TEST(DisparityError, CountsPixelsWithinTheBorderAndKnowsHowTheirConfidenceOrdersThem) {
  const Image truth = ramp(10, 10);
  Image estimate = truth, confidence(10, 10, 1);
  estimate.pixels[0] += 9;  // on the border
  for (size_t x = 1; x < 9; ++x) {
    estimate.pixels[10 + x] += 0.1F;
    estimate.pixels[20 + x] -= 0.3F;
  }
  for (size_t i = 30; i < 100; ++i) confidence.pixels[i] = 1;
  const auto error = compare(estimate, confidence, truth, 1);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->num_pixels, 64U);
  EXPECT_DOUBLE_EQ(error->bad_07_percent, 25);
  EXPECT_DOUBLE_EQ(error->bad_20_percent, 12.5);
  EXPECT_NEAR(error->mean_absolute_px, 0.05, 1e-6);
  ASSERT_EQ(error->most_certain.size(), 10U);
  EXPECT_EQ(error->most_certain[6].bad_20_percent, 0);  // 70 % of the pixels; 75 % are right
  EXPECT_DOUBLE_EQ(error->most_certain[9].bad_20_percent, 12.5);
}

TEST(DisparityError, HasTheSlopeByWhichParallaxIsReduced) {
  const Image truth = ramp(40, 40);
  Image estimate = truth;
  for (float& value : estimate.pixels) value = 0.3F + 0.36F * value;
  EXPECT_NEAR(compare(estimate, {}, truth)->slope, 0.36, 1e-5);
  EXPECT_EQ(compare(estimate, {}, Image(40, 40, 1))->slope, 0);
}

TEST(DisparityError, LeavesOutUnknownTruthAndCountsMissingEstimatesAsBad) {
  Image truth = ramp(4, 1), estimate = truth;
  truth.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  estimate.pixels[1] = std::numeric_limits<float>::infinity();
  const auto error = compare(estimate, Image(4, 1, 1), truth, 0);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->num_pixels, 3U);
  EXPECT_NEAR(error->bad_20_percent, 100.0 / 3, 1e-9);
  EXPECT_EQ(error->mean_absolute_px, 0);
}

TEST(DisparityError, RefusesMapsThatCannotBeCompared) {
  EXPECT_EQ(compare(ramp(40, 40), {}, ramp(40, 41)).error().code, ErrorCode::kShape);
  EXPECT_EQ(compare(ramp(30, 40), {}, ramp(30, 40)).error().code, ErrorCode::kShape);
  Image unknown(1, 1, 1);
  unknown.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(compare(Image(1, 1, 1), {}, unknown, 0).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::depth
