// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/recon/reconstruct.h"

namespace e2lf::recon {
namespace {

/// 8x8 views of a ramp from 0 to `brightest`.
lightfield::LightField ramp(float brightest) {
  lightfield::LightField light_field({8, 8, 64, 128});
  const auto data = light_field.data();
  for (size_t i = 0; i < data.size(); ++i) {
    data[i] = brightest * static_cast<float>(i % (64 * 128)) / (64 * 128 - 1);
  }
  return light_field;
}

TEST(AutoGain, BrightLevelOfADarkSceneBecomesNineTenths) {
  for (const float brightest : {0.05F, 0.2F, 0.6F, 1.5F}) {
    EXPECT_NEAR(auto_gain(ramp(brightest)) * 0.995F * brightest, 0.9F, 0.005F) << brightest;
  }
}

TEST(AutoGain, WellExposedSceneIsLeftAlone) {
  for (const float brightest : {0.71F, 0.9F, 1.0F}) EXPECT_EQ(auto_gain(ramp(brightest)), 1.0F) << brightest;
}

TEST(AutoGain, FewOutliersDoNotDecide) {
  auto light_field = ramp(0.2F);
  const auto data = light_field.data();
  for (size_t i = 0; i < data.size(); i += 500) data[i] = 100;
  data[1] = std::numeric_limits<float>::quiet_NaN();
  data[data.size() - 1] = std::numeric_limits<float>::infinity();
  EXPECT_NEAR(auto_gain(light_field), 0.9F / 0.2F, 0.05F);
}

TEST(AutoGain, StaysWithinItsRange) {
  EXPECT_EQ(auto_gain(ramp(1e-4F)), 64.0F);
  EXPECT_EQ(auto_gain(ramp(1e3F)), 0.25F);
}

TEST(AutoGain, CountsFromBlackAsIfItWereSubtracted) {
  auto light_field = ramp(0.37F);
  const float gain = auto_gain(light_field, 0.041F);
  apply_tone(light_field, 0.041F, 1.0F);
  EXPECT_EQ(gain, auto_gain(light_field));
}

TEST(AutoGain, SceneWithoutLightIsLeftAlone) {
  EXPECT_EQ(auto_gain(ramp(0)), 1.0F);
  EXPECT_EQ(auto_gain(lightfield::LightField()), 1.0F);
}

TEST(AutoBlack, IsTheDarkLevelWithinItsLimits) {
  lightfield::LightField field({8, 8, 10, 20});
  const auto fill = [&](float dark, float bright) {
    for (size_t i = 0; i < field.data().size(); ++i) field.data()[i] = i % 10 == 0 ? dark : bright;
  };
  fill(0.05F, 0.8F);
  EXPECT_FLOAT_EQ(auto_black(field), 0.05F);
  fill(-0.05F, 0.8F);
  EXPECT_EQ(auto_black(field), 0);
  fill(0.5F, 0.8F);
  EXPECT_FLOAT_EQ(auto_black(field), 0.12F);
  fill(0.0F, -1.0F);
  EXPECT_EQ(auto_black(field), 0);
  fill(0.05F, 0.8F);
  apply_tone(field, 0.05F, 2.0F);
  EXPECT_FLOAT_EQ(field.data()[0], 0);
  EXPECT_FLOAT_EQ(field.data()[1], 1.5F);
}

}  // namespace
}  // namespace e2lf::recon
