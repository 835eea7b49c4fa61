// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/count_distribution.h"

#include <gtest/gtest.h>
#include <numeric>

#include "e2lf/calibrate/fit.h"
#include "e2lf/capture/patterns/codes.h"
#include "testing/pixel_levels.h"
#include "testing/test_still_scenes.h"

namespace e2lf::calibrate {
namespace {

using enum capture::PixelConstant;

Area empty_area(size_t transitions = 3) {
  Area area;
  area.transitions = transitions;
  area.histogram.resize(histogram_size(transitions));
  return area;
}

/// The largest total variation of a group between the model's probabilities and what the simulation counts on one
/// brightness.
double distance_to_simulation(const capture::SensorProfile& camera, float brightness,
                              const capture::Codes& codes = capture::default_codes()) {
  lightfield::LightField field({8, 8, 256, 256});
  std::fill(field.data().begin(), field.data().end(), brightness);
  const StillScene scene = simulate(camera, field, 2, codes);
  const size_t transitions = codes.num_patterns - 1;
  std::vector<double> difference =
      predict(camera, open_shares(codes), empty_area(transitions), std::log(brightness / camera.pixel[kEps]));
  const auto groups = count_groups(transitions);
  for (const auto& cycle : scene.cycles) {
    for (size_t p = 0; p < cycle.image_size(); ++p) {
      for (const CountGroup& group : groups) {
        difference[group.cell_of([&](size_t n) { return cycle.image(n)[p]; })] -=
            0.5 / static_cast<double>(cycle.image_size());
      }
    }
  }
  double most = 0.0;
  for (const CountGroup& group : groups) {
    double sum = 0.0;
    for (size_t cell = 0; cell < group.size(); ++cell) sum += 0.5 * std::abs(difference[group.begin + cell]);
    most = std::max(most, sum);
  }
  return most;
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

TEST(CountDistribution, OfAWholeCycleIsThatOfTheSimulation) {
  const capture::Codes whole = capture::whole_cycle(capture::default_codes());
  for (const float brightness : {0.04F, 0.3F, 1.5F}) {
    EXPECT_LT(distance_to_simulation(plain_camera(), brightness, whole), 0.02) << brightness;
  }
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
  EXPECT_NEAR(model[count_groups(2).front().cell_of([](size_t n) { return n == 0 ? 5 : -1; })], 1.0, 1e-9);
}

TEST(CountDistribution, AgreesWithTheOtherFormsOfThePhysicalPixel) {
  constexpr float kThreshold = 0.6F;
  const auto pixel = capture::lagging_camera(kThreshold).pixel;
  const auto levels = capture::pixel_levels(pixel);
  PixelLight light{.inverse = capture::exposure_of(capture::kInverseLight, pixel), .of_patterns = {}};
  double reference = levels[0];
  std::vector<int> counts;
  for (size_t n = 0; n < 4; ++n) {
    light.of_patterns.push_back(capture::exposure_of(capture::kPatternLight[n], pixel));
    const int count = static_cast<int>((levels[n] - reference) / kThreshold);
    reference += count * static_cast<double>(kThreshold);
    if (n > 0) counts.push_back(count);
  }
  std::vector<double> model(histogram_size(3));
  count_distribution(pixel, light, model);
  EXPECT_NEAR(model[count_groups(3).front().cell_of([&](size_t n) { return counts[n]; })], 1.0, 1e-3);
}

}  // namespace
}  // namespace e2lf::calibrate
