// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/count_distribution.h"

#include <gtest/gtest.h>
#include <numeric>

#include "e2lf/calibrate/fit.h"
#include "testing/pixel_levels.h"
#include "testing/test_still_scenes.h"

namespace e2lf::calibrate {
namespace {

using enum capture::PixelConstant;

Area empty_area() {
  Area area;
  area.histogram.resize(histogram_size(3));
  return area;
}

/// The total variation between the model's probabilities and what the simulation counts on one brightness.
double distance_to_simulation(const capture::SensorProfile& camera, float brightness) {
  lightfield::LightField field({8, 8, 256, 256});
  std::fill(field.data().begin(), field.data().end(), brightness);
  const StillScene scene = simulate(camera, field, 2);
  const Area area = empty_area();
  std::vector<double> difference =
      predict(camera, open_shares(capture::default_codes()), area, std::log(brightness / camera.pixel[kEps]));
  for (const auto& cycle : scene.cycles) {
    for (size_t p = 0; p < cycle.image_size(); ++p) {
      size_t place = 0;
      for (size_t n = 0; n < 3; ++n) place = place * kNumCounts + count_place(cycle.image(n)[p]);
      difference[place] -= 0.5 / static_cast<double>(cycle.image_size());
    }
  }
  double sum = 0.0;
  for (const double each : difference) sum += 0.5 * std::abs(each);
  return sum;
}

TEST(CountDistribution, IsThatOfTheSimulation) {
  auto camera = plain_camera();
  for (const float brightness : {0.04F, 0.3F, 1.5F}) EXPECT_LT(distance_to_simulation(camera, brightness), 0.015);
  camera.pixel[kMismatchEach] = 0.1F;
  camera.pixel[kResetSpan] = 1.4F;
  EXPECT_LT(distance_to_simulation(camera, 0.3F), 0.015);
  camera.pixel[kThresholdOn] *= 1.1F;
  const double self = distance_to_simulation(camera, 0.3F);
  EXPECT_LT(self, 0.015);
}

TEST(CountDistribution, SumsToOne) {
  const auto camera = plain_camera();
  const auto shares = open_shares(capture::default_codes());
  for (const double brightness : {0.0, 3.0, 6.0}) {
    const auto model = predict(camera, shares, empty_area(), brightness);
    EXPECT_NEAR(std::accumulate(model.begin(), model.end(), 0.0), 1.0, 2e-3);
  }
}

TEST(CountDistribution, IsOneCombinationForPixelsWithoutAnyRandomness) {
  auto camera = plain_camera();
  for (const auto constant :
       {kMismatch, kMismatchEach, kNoise, kShotNoise, kResetSpan, kResetOffset, kDarkOff, kDarkOn}) {
    camera.pixel[constant] = 0.0F;
  }
  camera.pixel[kReceptorRate] = camera.pixel[kAmplifierRate] = 1e6F;
  // From black the level rises by ln 10.5, which is 5.88 times 0.4. So the reference is at 2.0, and ln 4 lies 1.75
  // times 0.35 below it.
  std::vector<double> model(histogram_size(2));
  count_distribution(camera.pixel, {.inverse = 5.0, .of_patterns = {1.0, 10.5, 4.0}}, model);
  EXPECT_NEAR(model[count_place(5) * kNumCounts + count_place(-1)], 1.0, 1e-9);
}

TEST(CountDistribution, AgreesWithTheOtherFormsOfThePhysicalPixel) {
  constexpr float kThreshold = 0.6F;
  const auto pixel = capture::lagging_camera(kThreshold).pixel;
  const auto levels = capture::pixel_levels(pixel);
  PixelLight light{.inverse = capture::exposure_of(capture::kInverseLight, pixel), .of_patterns = {}};
  double reference = levels[0];
  size_t cell = 0;
  for (size_t n = 0; n < 4; ++n) {
    light.of_patterns.push_back(capture::exposure_of(capture::kPatternLight[n], pixel));
    const int count = static_cast<int>((levels[n] - reference) / kThreshold);
    reference += count * static_cast<double>(kThreshold);
    if (n > 0) cell = cell * kNumCounts + count_place(count);
  }
  std::vector<double> model(histogram_size(3));
  count_distribution(pixel, light, model);
  EXPECT_NEAR(model[cell], 1.0, 1e-3);
}

}  // namespace
}  // namespace e2lf::calibrate
