// SPDX-License-Identifier: MIT
#include "e2lf/recon/event_check.h"

#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/lightfield/scene.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::recon {
namespace {

lightfield::LightField scene() {
  return lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 48, 64});
}

/// The simulator is the other implementation of the same counts.
class EventErrors : public testing::TestWithParam<sensor::EventModel> {};

TEST_P(EventErrors, VanishForTheEventsOfTheLightFieldItself) {
  const lightfield::LightField truth = scene();
  EventCheck check{capture::default_codes(), {}, GetParam()};
  sensor::EventModelOptions options;
  options.model = check.model;
  options.constants.sigma_w = options.constants.sigma_z = 0;
  const auto events = sensor::simulate_events(check.codes, truth, options).value();
  const EventError error = event_error(check, truth, 1.0F, events).value();
  EXPECT_LT(error.at_first, 2e-4);  // logarithms that round another way at a threshold
  EXPECT_EQ(error.residue, 0);

  lightfield::LightField brighter = truth;
  for (float& value : brighter.data()) value *= 2;
  EXPECT_LT(event_error(check, brighter, 2.0F, events).value().at_first, 2e-4);
  EXPECT_GT(event_error(check, brighter, 1.0F, events).value().at_first, 0.1);
}

TEST_P(EventErrors, TellHowFarReferencesStartAboveTheFirstIntensity) {
  const lightfield::LightField truth = scene();
  const EventCheck check{capture::default_codes(), {}, GetParam()};
  sensor::EventModelOptions options;
  options.model = check.model;
  options.constants.sigma_w = options.constants.sigma_z = 0;
  auto intensities = sensor::coded_intensities(check.codes, truth).value();
  const float raised = check.constants.eps * (std::exp(0.5F * check.constants.tau) - 1);
  for (float& value : intensities.image(0)) value = raised;
  const auto events = sensor::simulate_events(intensities, options).value();
  const EventError error = event_error(check, truth, 1.0F, events).value();
  EXPECT_EQ(error.residue, 0.5);
  EXPECT_LT(error.least, 2e-4);
  EXPECT_GT(error.at_first, 0.05);
}
INSTANTIATE_TEST_SUITE_P(Models, EventErrors,
                         testing::Values(sensor::EventModel::kQuantised, sensor::EventModel::kReferenceAware));

/// Physical pixels without anything random are counted exactly; with it, the right light field explains best.
TEST(EventErrors, OfPhysicalPixelsTellTheLightFieldAndTheCamera) {
  using enum capture::PixelConstant;
  const lightfield::LightField truth = scene();
  capture::SensorProfile camera;
  camera.event_model = "pixel";
  camera.pixel[kEps] = 0.01F;
  camera.pixel[kReceptorRate] = 30.0F;
  camera.pixel[kAmplifierRate] = 300.0F;
  camera.pixel[kThresholdOn] = camera.pixel[kThresholdOff] = 0.3F;
  camera.pixel[kBlackTime] = 0.0156F;
  camera.pixel[kLitTime] = 0.0104F;
  EventCheck check{capture::default_codes(), {}, sensor::EventModel::kReferenceAware, camera};
  const auto silent = sensor::simulate_pixel_events(check.codes, truth, camera, {.seed = 1}).value();
  EXPECT_EQ(event_error(check, truth, 1.0F, silent).value().at_first, 0);

  camera.pixel[kResetSpan] = 1.0F;
  camera.pixel[kMismatch] = 0.1F;
  camera.pixel[kNoise] = 0.05F;
  check.pixels = camera;
  const auto events = sensor::simulate_pixel_events(check.codes, truth, camera, {.seed = 1}).value();
  const double own = event_error(check, truth, 1.0F, events).value().least;
  lightfield::LightField darker = truth;
  for (float& value : darker.data()) value *= 0.5F;
  EXPECT_LT(own, 0.8 * event_error(check, darker, 1.0F, events).value().least);
  EXPECT_NEAR(own, event_error(check, darker, 0.5F, events).value().least, 1e-3);
  check.pixels.reset();
  EXPECT_LT(own, 0.8 * event_error(check, truth, 1.0F, events).value().least);
}

TEST(EventErrors, RefuseCodesAndSizesThatDoNotFit) {
  const EventCheck check{capture::default_codes(), {}};
  EXPECT_EQ(event_error(check, scene(), 1.0F, capture::EventImages(2, 48, 64)).error().code, ErrorCode::kShape);
  EXPECT_EQ(event_error(check, scene(), 1.0F, capture::EventImages(3, 48, 63)).error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::recon
