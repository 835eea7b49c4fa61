// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/field_check.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "e2lf/files/bundled_files.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::pipeline {
namespace {

/// Light fields of the demo scene and their events with physical pixels.
class FieldChecks : public testing::Test {
 protected:
  [[nodiscard]] capture::EventImages simulate(const lightfield::LightField& scene, uint64_t seed = 7) const {
    return sensor::simulate_pixel_events(*network_.codes, scene, *network_.camera, {.seed = seed}).value();
  }

  [[nodiscard]] FieldCheck check(size_t cycles = 1) const {
    const auto method = open_method({.model = network_}).value();
    return FieldCheck::create(method, cycles).value().value();
  }

  [[nodiscard]] Explanation judge(const lightfield::LightField& field, const capture::EventImages& events) const {
    return check().judge(field, events, false).value().value();
  }

  model::Model network_ = read_network(bundled_file_named(kBundledModels, "e2lf-n4-camera").value()).value();
  lightfield::LightField truth_ = lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 160, 200});
};

TEST_F(FieldChecks, CallTheLightFieldItselfGoodInBrightAndDarkScenes) {
  for (const float brightness : {1.0F, 0.2F}) {
    lightfield::LightField scene = truth_;
    for (float& value : scene.data()) value *= brightness;
    const Explanation explained = judge(scene, simulate(scene));
    EXPECT_NEAR(explained.ratio, 1.0, 0.05) << brightness;
    EXPECT_EQ(explained.verdict(true), "good") << to_json(explained.findings).dump();
    EXPECT_EQ(explained.verdict(false), "unconfirmed");
  }
}

TEST_F(FieldChecks, DoubtLightFieldsOfInvertedEvents) {
  capture::EventImages events = simulate(truth_);
  for (int16_t& count : events.values) count = static_cast<int16_t>(-count);
  EXPECT_TRUE(contains(judge(truth_, events).findings, "events-unexplained"));
}

TEST_F(FieldChecks, TrustNoLightFieldWithoutContrast) {
  lightfield::LightField fog = truth_;
  std::ranges::fill(fog.data(), 0.3F);
  EXPECT_EQ(judge(fog, simulate(fog)).verdict(true), "doubtful");
}

TEST_F(FieldChecks, SumsOfCyclesAreComparedPerCycle) {
  capture::EventImages sum = simulate(truth_, 1);
  EXPECT_EQ(pipeline::add_counts(simulate(truth_, 2), sum), 0U);
  const Explanation explained = check(2).judge(truth_, sum, false).value().value();
  EXPECT_NEAR(explained.ratio, 1.0, 0.1);
}

/// Slopes of the transmission are those of the whole width, of which the check sees a part.
TEST_F(FieldChecks, OfEventsWindowTheCameraAsThoseOfLightFields) {
  const lightfield::LightField wide = lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 64, 1024});
  model::Model sloped = network_;
  sloped.camera->transmission_slope_x = {0.8F, 0.8F, 0.8F};
  const auto events = sensor::simulate_pixel_events(*sloped.codes, wide, *sloped.camera, {.seed = 7}).value();
  const OpenedMethod method = open_method({.model = sloped}).value();
  const FieldCheck check = FieldCheck::create(method).value().value();
  const lightfield::LightField field = method.ready().value()(events, {}).value();
  const Explanation of_field = check.judge(field, events, false).value().value();
  const Explanation of_events = check.judge_events(events).value().value();
  EXPECT_NEAR(of_events.error, of_field.error, 0.02 * of_field.error);
}

TEST_F(FieldChecks, JudgeOnlyMethodsThatUseTheCamera) {
  const auto opened = [&](pipeline::MethodChoice choice) { return open_method(std::move(choice)).value(); };
  const auto is_judged = [&](const pipeline::OpenedMethod& method) {
    const auto made = FieldCheck::create(method).value();
    return made && made->judge(truth_, simulate(truth_), false).value().has_value();
  };
  EXPECT_FALSE(is_judged(opened({.algorithm = Algorithm::kInversion, .codes = network_.codes})));
  EXPECT_FALSE(
      is_judged(opened({.algorithm = Algorithm::kInversion, .codes = network_.codes, .camera = network_.camera})));
  EXPECT_TRUE(is_judged(opened({.model = network_, .codes = network_.codes})));
}

}  // namespace
}  // namespace e2lf::pipeline
