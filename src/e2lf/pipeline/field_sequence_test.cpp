// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/field_sequence.h"

#include <gtest/gtest.h>

#include "e2lf/recon/scene_motion.h"

namespace e2lf::pipeline {
namespace {

/// Returns a method whose light field is constant: the first count divided by 100.
Result<lightfield::LightField> constant_field(const capture::MeasurementView& measurement, const ProgressFn&) {
  const capture::EventImages images = owned(measurement.events);
  if (images.values[0] < 0) return Error{ErrorCode::kInvalidValue, "no light", ""};
  lightfield::LightField field({8, 8, images.height, images.width});
  for (float& value : field.data()) value = static_cast<float>(images.values[0]) / 100;
  return field;
}

capture::EventImages images_of(int16_t count) {
  capture::EventImages images(3, 4, 5);
  images.values[0] = count;
  return images;
}

TEST(FieldSequence, KeepsTheGainOfTheFirst) {
  FieldSequence sequence(constant_field, {});
  EXPECT_FALSE(sequence.tone().gain);
  const Field first = sequence.next(images_of(30)).value();
  EXPECT_FLOAT_EQ(first.gain, 3);  // to 0.9
  EXPECT_FLOAT_EQ(first.light_field.data()[7], 0.9F);
  const Field second = sequence.next(images_of(10)).value();
  EXPECT_FLOAT_EQ(second.gain, 3);
  EXPECT_FLOAT_EQ(second.light_field.data()[7], 0.3F);
}

TEST(FieldSequence, KeepsTheBlackOfTheFirst) {
  FieldSequence sequence(constant_field, {.black = std::nullopt});
  const Field first = sequence.next(images_of(30)).value();
  EXPECT_FLOAT_EQ(first.black, 0.045F);  // at most 0.15 of the bright level
  EXPECT_FLOAT_EQ(first.gain, 0.9F / 0.255F);
  EXPECT_FLOAT_EQ(first.light_field.data()[7], 0.9F);
  EXPECT_NEAR(sequence.next(images_of(4)).value().light_field.data()[7], (0.04 - 0.045) * 0.9 / 0.255, 1e-6);
}

TEST(FieldSequence, TakesAGivenGainAndHandsOnWhatFails) {
  FieldSequence sequence(constant_field, {.gain = 2.0F});
  EXPECT_FLOAT_EQ(sequence.next(images_of(30)).value().light_field.data()[0], 0.6F);
  EXPECT_EQ(sequence.next(images_of(-1)).error().message, "no light");
}

TEST(FieldSequence, ShowsTheObserverTheUnprocessedLightField) {
  FieldSequence sequence(constant_field, {.gain = 2.0F});
  const auto observe = [](const lightfield::LightField& field, const capture::Measurement& used, bool) -> Result<void> {
    EXPECT_FLOAT_EQ(field.data()[0], 0.01F * static_cast<float>(used.events.values[0]));
    return Error{ErrorCode::kInvalidValue, "seen", ""};
  };
  EXPECT_EQ(sequence.next(images_of(30), {}, observe).error().message, "seen");
}

TEST(FieldSequence, TakesTheLitTransitionsOfCyclesInWhichTheSceneMoves) {
  const recon::Method lit = [](const capture::MeasurementView& measured,
                               const ProgressFn&) -> Result<lightfield::LightField> {
    EXPECT_EQ(measured.events.extents[0], 3U);
    return lightfield::LightField({8, 8, measured.height(), measured.width()});
  };
  FieldSequence sequence(constant_field, {.gain = 1.0F}, 1, lit);
  // The second of the two last patterns is brighter on the left, its inverse is not darker there.
  capture::EventImages moving(8, 32, 32), still(8, 32, 32);
  for (size_t i = 0; i < moving.image_size(); ++i) moving.image(2)[i] = i % 8 < 4 ? 5 : 0;
  moving.values[0] = still.values[0] = 30;
  const Field of_whole = sequence.next(still).value();
  EXPECT_FALSE(of_whole.is_of_lit);
  EXPECT_LT(*of_whole.motion, recon::kMuchMotion);
  EXPECT_FLOAT_EQ(of_whole.light_field.data()[0], 0.3F);
  const Field of_lit = sequence.next(moving).value();
  EXPECT_TRUE(of_lit.is_of_lit);
  EXPECT_GT(*of_lit.motion, recon::kMuchMotion);
  EXPECT_FLOAT_EQ(of_lit.light_field.data()[0], 0);
}

// The same counts as the sum over 16 cycles are a third of an event per cycle, which rounding explains.
TEST(FieldSequence, DividesSumsOfCyclesBeforeItLooksForMotion) {
  capture::EventImages sum(8, 32, 32), moving(8, 32, 32);
  for (size_t i = 0; i < sum.image_size(); ++i) sum.image(2)[i] = i % 8 < 4 ? 5 : 0;
  for (size_t i = 0; i < sum.values.size(); ++i) moving.values[i] = static_cast<int16_t>(16 * sum.values[i]);
  for (const size_t cycles : {1U, 16U}) {
    FieldSequence sequence(constant_field, {.gain = 1.0F}, cycles, constant_field);
    const Field field = sequence.next(sum).value();
    EXPECT_EQ(field.is_of_lit, cycles == 1);
    EXPECT_EQ(*field.motion == 0, cycles == 16);
  }
  FieldSequence sequence(constant_field, {.gain = 1.0F}, 16, constant_field);
  const Field field = sequence.next(moving).value();
  EXPECT_TRUE(field.is_of_lit);
  EXPECT_FLOAT_EQ(static_cast<float>(*field.motion), static_cast<float>(recon::scene_motion(sum)));
}

TEST(FieldSequence, KeepsWhatIsFusedOfTheLitTransitions) {
  const recon::Method lit = [](const capture::MeasurementView& measured,
                               const ProgressFn&) -> Result<lightfield::LightField> {
    EXPECT_TRUE(measured.is_fused());
    EXPECT_EQ(measured.fused.extents, measured.events.extents);
    EXPECT_EQ(measured.fused[2][0][0], 7);
    EXPECT_EQ(measured.cycles[0][0][0], 4);
    return lightfield::LightField({8, 8, measured.height(), measured.width()});
  };
  FieldSequence sequence(constant_field, {.gain = 1.0F}, 1, lit);
  capture::Measurement moving(capture::EventImages(8, 32, 32));
  for (size_t i = 0; i < moving.events.image_size(); ++i) moving.events.image(2)[i] = i % 8 < 4 ? 5 : 0;
  moving.fused = {capture::EventImages(8, 32, 32), Planes<float>(1, 32, 32)};
  moving.fused.counts.image(2)[0] = 7;
  moving.fused.cycles.values[0] = 4;
  EXPECT_TRUE(sequence.next(moving).value().is_of_lit);
}

}  // namespace
}  // namespace e2lf::pipeline
