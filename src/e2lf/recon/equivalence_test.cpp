// SPDX-License-Identifier: MIT
#include "e2lf/recon/equivalence.h"

#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/lightfield/demo_scene.h"

namespace e2lf::recon {
namespace {

lightfield::LightField demo() {
  return lightfield::render_light_field(lightfield::demo_scene(1), {8, 8, 48, 64, 1});
}

sensor::EventModelOptions sensor_of(float tau, float noise) {
  sensor::EventModelOptions options;
  options.constants = {.tau = tau, .sigma_w = 0.175F * noise, .sigma_z = 0.04F * noise};
  return options;
}

const std::vector<size_t> kBlackLast = {1, 2, 3, 0};

TEST(Equivalence, ErrorsVanishWithTheThreshold) {
  const auto codes = capture::default_codes();
  double before = INFINITY;
  for (const float tau : {0.4F, 0.1F, 0.025F}) {
    const Equivalence found = measure_equivalence(codes, kBlackLast, demo(), sensor_of(tau, 0)).value();
    // Counting toward zero leaves at most one threshold: I + eps is off by a factor of exp(tau) at most.
    EXPECT_LT(found.intensity_error, 1.3 * std::expm1(tau));
    EXPECT_LT(found.centred_error, found.intensity_error);
    EXPECT_LT(found.intensity_error, before);
    before = found.intensity_error;
    // Each count is off by less than one event at either end, however many events there are.
    EXPECT_LT(found.permuted_error, 1.5);
    EXPECT_EQ(found.repeated_error, 0);
  }
}

/// One pattern after black, everywhere 0.2 bright: with thresholds of 0.3 ln(21) makes 10 events.
TEST(Equivalence, ErrorOfAnEvenSceneIsThatOfTheCount) {
  capture::Codes codes(2, 8, 8);
  for (float& cell : codes.pattern(1)) cell = 1.0F;
  lightfield::LightField scene({8, 8, 4, 4});
  for (float& value : scene.data()) value = 0.2F;
  const Equivalence found = measure_equivalence(codes, {1, 0}, scene, sensor_of(0.3F, 0)).value();
  EXPECT_EQ(found.events_per_pixel, 10);
  EXPECT_EQ(found.permuted_events_per_pixel, 10);
  EXPECT_EQ(found.permuted_error, 0);
  EXPECT_NEAR(found.intensity_error, std::abs(0.01 * std::expm1(3.0) - 0.2) / 0.2, 1e-4);
  EXPECT_NEAR(found.centred_error, std::abs(0.01 * std::expm1(3.15) - 0.2) / 0.2, 1e-4);
}

TEST(Equivalence, NoiseAloneExplainsMostOfTheDifferenceOfOrders) {
  const Equivalence found =
      measure_equivalence(capture::default_codes(), kBlackLast, demo(), sensor_of(0.3F, 1)).value();
  EXPECT_GT(found.repeated_error, 0.3);
  EXPECT_LT(found.permuted_error, 3 * found.repeated_error);
}

TEST(Equivalence, NeedsABlackPattern) {
  capture::Codes codes(2, 8, 8);
  for (float& cell : codes.values) cell = 1.0F;
  EXPECT_EQ(measure_equivalence(codes, {1, 0}, demo(), {}).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::recon
