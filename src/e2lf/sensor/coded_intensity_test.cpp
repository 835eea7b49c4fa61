// SPDX-License-Identifier: MIT

#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/threads.h"
#include "e2lf/sensor/event_model.h"
#include "testing/event_reference.h"

namespace e2lf::sensor {
namespace {

/// Noise in [0, 1); sizes that no vector length divides, and more than one block.
lightfield::LightField random_light_field(const lightfield::Shape& shape = {4, 3, 61, 83}) {
  lightfield::LightField light_field(shape);
  const CounterRng rng(1, 0);
  for (size_t i = 0; i < light_field.data().size(); ++i) light_field.data()[i] = rng.uniform(i);
  return light_field;
}

capture::Codes random_codes(size_t num_patterns, size_t views_y, size_t views_x) {
  capture::Codes codes(num_patterns, views_y, views_x);
  const CounterRng rng(2, 0);
  for (size_t i = 0; i < codes.values.size(); ++i) codes.values[i] = rng.uniform(i);
  return codes;
}

TEST(CodedIntensity, AViewOfMemoryGivesWhatItsCopyGives) {
  const auto light_field = random_light_field();
  const LightFieldView flipped = LightFieldView(light_field).reversed(1).reversed(3);
  const auto codes = random_codes(3, 4, 3);
  EXPECT_EQ(coded_intensities(codes, flipped).value(),
            coded_intensities(codes, lightfield::LightField(flipped)).value());
}

TEST(CodedIntensity, OpenApertureIsTheMeanOfTheViews) {
  const auto light_field = random_light_field();
  capture::Codes open(1, 4, 3);
  for (float& value : open.values) value = 1;
  const auto intensities = coded_intensities(open, light_field);
  ASSERT_TRUE(intensities);
  for (size_t pixel = 0; pixel < 61 * 83; ++pixel) {
    double mean = 0;
    for (size_t view = 0; view < 12; ++view) mean += light_field.data()[view * 61 * 83 + pixel] / 12.0;
    ASSERT_NEAR(intensities->values[pixel], mean, 1e-6);
  }
}

TEST(CodedIntensity, PatternAndComplementAddUpToTheOpenAperture) {
  capture::Codes codes = random_codes(3, 4, 3);
  for (size_t v = 0; v < 12; ++v) {
    codes.pattern(1)[v] = 1 - codes.pattern(0)[v];
    codes.pattern(2)[v] = 1;
  }
  const auto intensities = coded_intensities(codes, random_light_field());
  ASSERT_TRUE(intensities);
  for (size_t i = 0; i < intensities->image_size(); ++i) {
    ASSERT_NEAR(intensities->image(0)[i] + intensities->image(1)[i], intensities->image(2)[i], 1e-6);
  }
}

TEST(CodedIntensity, BlackPatternSeesNothing) {
  const auto intensities = coded_intensities(capture::Codes(1, 4, 3), random_light_field());
  ASSERT_TRUE(intensities);
  for (const float value : intensities->values) ASSERT_EQ(value, 0);
}

TEST(CodedIntensity, EveryInstructionSetAndThreadCountGivesTheReference) {
  const auto light_field = random_light_field();
  const capture::Codes codes = random_codes(5, 4, 3);
  const auto expected = reference_coded_intensities(codes, light_field);
  ASSERT_TRUE(expected);
  for (const std::string& isa : available_isas()) {
    ASSERT_TRUE(set_max_isa(isa));
    for (const int threads : {1, 3}) {
      set_num_threads(threads);
      const auto intensities = coded_intensities(codes, light_field);
      ASSERT_TRUE(intensities);
      EXPECT_EQ(intensities->values, expected->values) << isa << ", threads: " << threads;
    }
  }
  ASSERT_TRUE(set_max_isa(""));
  set_num_threads(0);
}

TEST(CodedIntensity, CodesAndLightFieldMustFit) {
  const auto views = coded_intensities(random_codes(2, 3, 4), random_light_field());
  ASSERT_FALSE(views);
  EXPECT_EQ(views.error().code, ErrorCode::kShape);
  const auto colour = coded_intensities(random_codes(2, 4, 3), random_light_field({4, 3, 5, 7, 3}));
  ASSERT_FALSE(colour);
  EXPECT_EQ(colour.error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::sensor
