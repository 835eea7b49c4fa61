// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "e2lf/video/video_model.h"

namespace e2lf::video {
namespace {

TEST(Quantile, InterpolatesBetweenTheSortedValues) {
  std::vector<float> values = {4.0F, 1.0F, 3.0F, 2.0F, 10.0F};
  EXPECT_FLOAT_EQ(quantile(values, 0.0), 1.0F);
  EXPECT_FLOAT_EQ(quantile(values, 0.5), 3.0F);
  EXPECT_FLOAT_EQ(quantile(values, 0.625), 3.5F);
  EXPECT_FLOAT_EQ(quantile(values, 0.9), 4.0F + 0.6F * 6.0F);
  EXPECT_FLOAT_EQ(quantile(values, 1.0), 10.0F);
}

/// 0, 1, ... 200: the quantiles are 2 and 198.
std::vector<float> ramp() {
  std::vector<float> values(201);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  return values;
}

TEST(ApplyTone, RobustPutsTheQuantilesAtBlackAndWhite) {
  std::vector<float> frame = ramp();
  apply_frame_tone(video::FrameTone::kRobust, frame);
  EXPECT_EQ(frame[0], 0.0F);
  EXPECT_NEAR(frame[2], 0.0F, 1e-6);
  EXPECT_NEAR(frame[100], 0.5F, 1e-6);
  EXPECT_NEAR(frame[198], 1.0F, 1e-6);
  EXPECT_EQ(frame[200], 1.0F);
}

TEST(ApplyTone, ExpRobustIsTheSameOfTheExponential) {
  std::vector<float> frame = ramp(), expected = ramp();
  for (float& value : frame) value = std::log(1.0F + value);
  apply_frame_tone(video::FrameTone::kExpRobust, frame);
  apply_frame_tone(video::FrameTone::kRobust, expected);
  for (size_t i = 0; i < frame.size(); ++i) EXPECT_NEAR(frame[i], expected[i], 1e-5);
}

TEST(ApplyTone, StandardTakesTheExtremesAndNoneOnlyClamps) {
  std::vector<float> frame = {-2.0F, 0.5F, 8.0F}, plain = frame;
  apply_frame_tone(video::FrameTone::kStandard, frame);
  EXPECT_EQ(frame, (std::vector<float>{0.0F, 0.25F, 1.0F}));
  apply_frame_tone(video::FrameTone::kNone, plain);
  EXPECT_EQ(plain, (std::vector<float>{0.0F, 0.5F, 1.0F}));
}

TEST(ApplyTone, AFrameOfOneValueIsBlack) {
  std::vector<float> frame(5, 0.7F);
  apply_frame_tone(video::FrameTone::kRobust, frame);
  EXPECT_EQ(frame, std::vector<float>(5, 0.0F));
}

}  // namespace
}  // namespace e2lf::video
