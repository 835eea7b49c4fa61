// SPDX-License-Identifier: MIT
#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/sensor/event_model.h"

namespace e2lf::sensor {
namespace {

using capture::MeasurementKind;

/// View v has the value v / 64 at the upper left, one 1000th more with each row, two with each column.
lightfield::LightField ramp(size_t height, size_t width) {
  lightfield::LightField field({8, 8, height, width});
  for (size_t i = 0; i < field.data().size(); ++i) {
    const size_t view = i / (height * width), y = i / width % height, x = i % width;
    field.data()[i] = static_cast<float>(view) / 64 + static_cast<float>(y + 2 * x) / 1000;
  }
  return field;
}

TEST(IntensityImages, WithoutNoiseCodedImagesAreCodedIntensitiesAndAHybridHasTheirSum) {
  const auto codes = capture::default_codes();
  const auto field = ramp(5, 7);
  const auto expected = coded_intensities(codes, field).value();
  const auto coded = measure_images(MeasurementKind::kCodedImages, codes, field, {.sigma = 0, .gain = 0.5F}).value();
  const auto sum = measure_images(MeasurementKind::kHybrid, codes, field, {.sigma = 0, .gain = 0.5F}).value();
  ASSERT_EQ(coded.count, 4U);
  ASSERT_EQ(sum.count, 1U);
  for (size_t i = 0; i < sum.values.size(); ++i) {
    float total = 0;
    for (size_t n = 0; n < 4; ++n) {
      EXPECT_FLOAT_EQ(coded.image(n)[i], 0.5F * expected.image(n)[i]);
      total += 0.5F * expected.image(n)[i];
    }
    EXPECT_FLOAT_EQ(sum.values[i], total);
  }
  EXPECT_EQ(measure_images(MeasurementKind::kEventImages, codes, field, {}).value().count, 0U);
}

TEST(IntensityImages, EachPixelUnderALensIsAViewOverTheArea) {
  const auto image = measure_images(MeasurementKind::kLensArray, {}, ramp(16, 11), {.sigma = 0}).value();
  ASSERT_EQ(image.count, 1U);
  ASSERT_EQ(image.height, 16U);
  ASSERT_EQ(image.width, 16U);  // the second lens is cut after 3 columns
  // Lens (1, 0), view (2, 5): rows 8..15, columns 0..7.
  EXPECT_NEAR(image.values[(8 + 2) * 16 + 5], 21.0 / 64 + (11.5 + 2 * 3.5) / 1000, 1e-6);
  // Lens (0, 1), view (7, 0): rows 0..7, columns 8..10.
  EXPECT_NEAR(image.values[7 * 16 + 8], 56.0 / 64 + (3.5 + 2 * 9) / 1000, 1e-6);
}

TEST(IntensityImages, NoiseHasItsWidthAndDiffersFromImageToImage) {
  lightfield::LightField field({8, 8, 64, 64});
  const auto codes = capture::default_codes();
  const auto noise = measure_images(MeasurementKind::kCodedImages, codes, field, {.sigma = 0.02F, .seed = 3}).value();
  double sum = 0, squares = 0, product = 0;
  for (const float value : noise.values) {
    sum += value;
    squares += value * value;
  }
  for (size_t i = 0; i < noise.image_size(); ++i) product += noise.image(1)[i] * noise.image(2)[i];
  const auto count = static_cast<double>(noise.values.size());
  EXPECT_NEAR(sum / count, 0, 5 * 0.02 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.0005);
  EXPECT_NEAR(product / static_cast<double>(noise.image_size()) / (0.02 * 0.02), 0, 0.1);
  EXPECT_EQ(noise.values,
            measure_images(MeasurementKind::kCodedImages, codes, field, {.sigma = 0.02F, .seed = 3}).value().values);
}

TEST(IntensityImages, RefusesWhatIsNoImage) {
  lightfield::LightField field({3, 3, 8, 8});
  EXPECT_EQ(measure_images(MeasurementKind::kLensArray, {}, field, {}).error().code, ErrorCode::kShape);
  EXPECT_EQ(measure_images(MeasurementKind::kLensArray, {}, ramp(8, 8), {.sigma = -1}).error().code,
            ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::sensor
