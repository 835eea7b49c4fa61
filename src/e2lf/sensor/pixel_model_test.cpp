// SPDX-License-Identifier: MIT
#include "e2lf/sensor/pixel_model.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>

#include "e2lf/base/threads.h"
#include "e2lf/sensor/event_model.h"
#include "testing/pixel_levels.h"

namespace e2lf::sensor {
namespace {

using enum capture::PixelConstant;

/// Follows the light at once; pixels are equal and start at black exactly.
capture::SensorProfile ideal_camera(float tau = 0.3F) {
  capture::SensorProfile camera;
  camera.event_model = "pixel";
  camera.pixel[kEps] = 0.01F;
  camera.pixel[kReceptorRate] = camera.pixel[kAmplifierRate] = 1e9F;
  camera.pixel[kThresholdOn] = camera.pixel[kThresholdOff] = tau;
  camera.pixel[kBlackTime] = 0.0156F;
  camera.pixel[kLitTime] = 0.0104F;
  return camera;
}

/// Black, the left half, the right half of 8x8 cells.
capture::Codes half_codes() {
  capture::Codes codes(3, 8, 8);
  for (size_t cell = 0; cell < 64; ++cell) codes.values[(cell % 8 < 4 ? 1 : 2) * 64 + cell] = 1.0F;
  return codes;
}

/// Every view has the same ramp of brightness.
lightfield::LightField ramp(size_t height, size_t width, float brightest) {
  lightfield::LightField field({8, 8, height, width});
  for (size_t i = 0; i < field.data().size(); ++i) {
    field.data()[i] = brightest * static_cast<float>(i % (height * width)) / static_cast<float>(height * width);
  }
  return field;
}

TEST(PixelModel, IsEquations9And10WithoutLagAndMismatch) {
  const auto codes = half_codes();
  const auto field = ramp(64, 64, 0.8F);
  EventModelOptions paper;
  paper.constants = {.eps = 0.01F, .tau = 0.3F, .sigma_w = 0.0F, .sigma_z = 0.0F};
  const auto expected = simulate_events(codes, field, paper);
  const auto found = simulate_pixel_events(codes, field, ideal_camera(), {});
  ASSERT_TRUE(expected && found);
  size_t different = 0;
  for (size_t i = 0; i < expected->values.size(); ++i) different += expected->values[i] != found->values[i] ? 1 : 0;
  EXPECT_LE(different, expected->values.size() / 500);  // quotients within rounding of a whole number
}

TEST(PixelModel, WholeCycleIsEquations9And10WithoutLagAndMismatch) {
  const auto codes = capture::whole_cycle(half_codes());
  const auto field = ramp(64, 64, 0.8F);
  EventModelOptions paper;
  paper.constants = {.eps = 0.01F, .tau = 0.3F, .sigma_w = 0.0F, .sigma_z = 0.0F};
  const auto expected = simulate_events(codes, field, paper);
  const auto found = simulate_pixel_events(codes, field, ideal_camera(), {});
  ASSERT_TRUE(expected && found);
  ASSERT_EQ(found->count, 6U);
  size_t different = 0;
  for (size_t k = 0; k < 6; ++k) {
    for (size_t p = 0; p < expected->image_size(); ++p) {
      const int difference = expected->image(k)[p] - found->image(k)[p];
      // On the way back to black every quotient is a whole number but for rounding.
      ASSERT_LE(std::abs(difference), 1) << "image " << k;
      if (k < 5) different += difference != 0 ? 1 : 0;
    }
  }
  EXPECT_LE(different, expected->values.size() / 300);  // quotients within rounding of a whole number
}

TEST(PixelModel, InverseLetsThroughWhatItsCodeHoldsBack) {
  constexpr float kThreshold = 0.01F;
  auto camera = ideal_camera(kThreshold);
  camera.transmission = {0.8F, 1.0F};
  lightfield::LightField field({8, 8, 1, 1});
  std::fill(field.data().begin(), field.data().end(), 0.2F);
  const auto counts = simulate_pixel_events(capture::whole_cycle(half_codes()), field, camera, {});
  ASSERT_TRUE(counts);
  const auto level = [](float light) { return std::log(light / 0.01F + 1.0F); };
  // Black, 0.08, 0.1, white, and then what the two halves hold back of 0.2.
  const float lights[] = {0.0F, 0.08F, 0.1F, 0.2F, 0.12F, 0.1F, 0.0F};
  for (size_t n = 1; n < 7; ++n) {
    EXPECT_NEAR(counts->image(n - 1)[0] * kThreshold, level(lights[n]) - level(lights[n - 1]), 2 * kThreshold) << n;
  }
}

TEST(PixelModel, AgreesWithTheOtherFormsOfThePhysicalPixel) {
  constexpr float kThreshold = 0.01F;
  const auto camera = capture::lagging_camera(kThreshold);
  capture::Codes codes(4, 8, 8);
  for (size_t i = 0; i < codes.values.size(); ++i) {
    codes.values[i] = static_cast<float>(capture::kPatternLight[i / 64] / capture::kFullLight);
  }
  lightfield::LightField field({8, 8, 1, 1});
  std::ranges::fill(field.data(), static_cast<float>(capture::kFullLight));
  const auto images = simulate_pixel_events(codes, field, camera, {});
  ASSERT_TRUE(images) << images.error().text();
  const auto levels = capture::pixel_levels(camera.pixel);
  for (size_t n = 1; n < 4; ++n) {
    EXPECT_NEAR(images->values[n - 1] * kThreshold, levels[n] - levels[n - 1], 2 * kThreshold) << n;
  }
}

TEST(PixelModel, ThresholdsStayFromCycleToCycleAndNoiseDoesNot) {
  auto camera = ideal_camera(0.1F);
  camera.pixel[kMismatch] = 0.1F;
  const auto codes = half_codes();
  lightfield::LightField field({8, 8, 64, 64});
  std::fill(field.data().begin(), field.data().end(), 0.5F);
  const auto images_of = [&](uint64_t seed, uint64_t map_seed) {
    return simulate_pixel_events(codes, field, camera, {.seed = seed, .map_seed = map_seed}).value().values;
  };
  EXPECT_EQ(images_of(1, 7), images_of(2, 7));
  EXPECT_NE(images_of(1, 7), images_of(1, 8));
  camera.pixel[kNoise] = 0.1F;
  EXPECT_NE(images_of(1, 7), images_of(2, 7));
}

TEST(PixelModel, IsTheSameForAnyNumberOfThreads) {
  auto camera = ideal_camera();
  camera.pixel[kMismatch] = camera.pixel[kNoise] = camera.pixel[kDarkOff] = 0.1F;
  const auto field = ramp(70, 50, 1.0F);
  const int threads = num_threads();
  set_num_threads(1);
  const auto one = simulate_pixel_events(half_codes(), field, camera, {.seed = 3});
  set_num_threads(3);
  const auto three = simulate_pixel_events(half_codes(), field, camera, {.seed = 3});
  set_num_threads(threads);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->values, three->values);
}

TEST(PixelModel, TransmissionChangesOverThePicture) {
  constexpr float kThreshold = 0.001F, kSlopeX = 0.3F, kSlopeY = -0.2F;
  auto camera = ideal_camera(kThreshold);
  camera.transmission = {1.0F, 1.0F};
  camera.transmission_slope_x = {0.0F, kSlopeX};
  camera.transmission_slope_y = {0.0F, kSlopeY};
  lightfield::LightField field({8, 8, 20, 40});
  std::fill(field.data().begin(), field.data().end(), 100.0F);  // so that the dark level is nothing
  const auto counts = simulate_pixel_events(half_codes(), field, camera, {});
  ASSERT_TRUE(counts);
  // Both halves are as bright, so the second change is that of the transmission alone. A pixel is 0.05 wide.
  const auto change = [&](size_t y, size_t x) { return kThreshold * counts->image(1)[y * 40 + x]; };
  EXPECT_NEAR(change(9, 39), kSlopeX * 0.975F + kSlopeY * -0.025F, 2 * kThreshold);
  EXPECT_NEAR(change(0, 0), kSlopeX * -0.975F + kSlopeY * -0.475F, 2 * kThreshold);
}

TEST(PixelModel, RefusesOtherCamerasAndPatternsWithoutBlack) {
  const auto field = ramp(4, 4, 1.0F);
  EXPECT_EQ(simulate_pixel_events(half_codes(), field, {}, {}).error().code, ErrorCode::kInvalidValue);
  auto open = half_codes();
  std::fill(open.values.begin(), open.values.end(), 1.0F);
  EXPECT_EQ(simulate_pixel_events(open, field, ideal_camera(), {}).error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::sensor
