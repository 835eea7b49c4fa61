// SPDX-License-Identifier: MIT
#include "e2lf/sensor/pixel_model.h"

#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/events/event_simulation.h"
#include "testing/pixel_levels.h"

namespace e2lf::learn {
namespace {

using enum capture::PixelConstant;

/// A camera that follows the light at once, whose pixels are equal and whose references start at black exactly.
capture::SensorProfile ideal_camera(float tau = 0.3F) {
  capture::SensorProfile camera;
  camera.event_model = "pixel";
  camera.constants = {.eps = 0.01F, .tau = tau, .sigma_w = 0.0F, .sigma_z = 0.0F};
  camera.pixel[kEps] = 0.01F;
  camera.pixel[kReceptorRate] = camera.pixel[kAmplifierRate] = 1e9F;
  camera.pixel[kThresholdOn] = camera.pixel[kThresholdOff] = tau;
  camera.pixel[kBlackTime] = 0.0156F;
  camera.pixel[kLitTime] = 0.0104F;
  return camera;
}

torch::Tensor events_of(const capture::SensorProfile& camera, const torch::Tensor& intensities,
                        const torch::Tensor& full, size_t cycles = 1) {
  const auto num_patterns = static_cast<size_t>(intensities.size(1));
  const size_t num_codes = num_patterns % 2 == 1 && num_patterns >= 5 ? (num_patterns - 1) / 2 : num_patterns;
  return simulate_pixel_events(intensities, full,
                               sample_of(camera, num_patterns, num_codes, cycles, torch::kCPU).pixel);
}

/// Coded intensities of four patterns, the first black, and what all cells together pass.
torch::Tensor random_intensities(int64_t size) {
  auto intensities = torch::rand({1, 4, size, size}) * 0.2;
  intensities.select(1, 0).zero_();
  return intensities;
}

TEST(PixelModel, IsEquations9And10WithoutLagAndMismatch) {
  torch::manual_seed(1);
  const auto intensities = random_intensities(64), full = torch::full({1, 64, 64}, 0.5);
  const auto camera = ideal_camera();
  const auto constants = repeat_constants(camera.constants, 1, torch::kCPU);
  const SensorNoise none{torch::zeros({1, 3, 64, 64}), torch::zeros({1, 3, 64, 64})};
  const auto expected = simulate_events(intensities, constants, none, EventModel::kReferenceAware);
  const auto found = events_of(camera, intensities, full);
  // A quotient within rounding of a whole number may fall to either side.
  EXPECT_LT((found != expected).to(torch::kFloat).mean().item<double>(), 1e-3);
  EXPECT_GT(expected.abs().mean().item<double>(), 1.0);
}

TEST(PixelModel, WholeCycleIsEquations9And10WithoutLagAndMismatch) {
  torch::manual_seed(4);
  const auto codes = random_intensities(64), full = torch::full({1, 64, 64}, 0.5);
  const auto intensities = torch::cat({codes, full.unsqueeze(1) - codes, codes.slice(1, 0, 1)}, 1);
  const auto camera = ideal_camera();
  const auto constants = repeat_constants(camera.constants, 1, torch::kCPU);
  const SensorNoise none{torch::zeros({1, 8, 64, 64}), torch::zeros({1, 8, 64, 64})};
  const auto expected = simulate_events(intensities, constants, none, EventModel::kReferenceAware);
  const auto found = events_of(camera, intensities, full);
  // On the way back to black every quotient is a whole number but for rounding.
  EXPECT_LE((found - expected).abs().max().item<double>(), 1.0);
  const auto before_black = (found != expected).slice(1, 0, 7);
  EXPECT_LT(before_black.to(torch::kFloat).mean().item<double>(), 3e-3);
  EXPECT_GT(expected.abs().mean().item<double>(), 1.0);
}

TEST(PixelModel, AgreesWithTheOtherFormsOfThePhysicalPixel) {
  constexpr float kThreshold = 0.01F;
  const auto camera = capture::lagging_camera(kThreshold);
  auto intensities = torch::zeros({1, 4, 1, 1});
  for (int64_t n = 0; n < 4; ++n) intensities[0][n] = capture::kPatternLight[n];
  const auto counts = events_of(camera, intensities, torch::full({1, 1, 1}, capture::kFullLight));
  const auto levels = capture::pixel_levels(camera.pixel);
  for (size_t n = 1; n < 4; ++n) {
    const double step = counts[0][static_cast<int64_t>(n) - 1][0][0].item<double>() * kThreshold;
    EXPECT_NEAR(step, levels[n] - levels[n - 1], 2 * kThreshold) << n;
  }
}

TEST(PixelModel, LightThatDoesNotChangeIsThatOfAStillScene) {
  const auto camera = capture::lagging_camera(0.05F);
  const auto views = torch::rand({1, 64, 16, 16}), full = views.mean(1);
  const auto intensities =
      coded_intensities(views, to_tensor(capture::whole_cycle(capture::default_codes()), torch::kCPU));
  const auto samples = sample_of(camera, 9, 4, 1, torch::kCPU).pixel;
  const auto still = simulate_pixel_events(intensities, full, samples);
  const auto moving = simulate_pixel_events(intensities, full.unsqueeze(1).expand({1, 9, 16, 16}), samples);
  // Quotients within rounding of a whole number may fall to either side.
  EXPECT_LT((still != moving).to(torch::kFloat).mean().item<double>(), 0.01);
}

TEST(PixelModel, SlowAmplifierLeavesPartOfTheStepForTheNextPattern) {
  auto camera = ideal_camera(0.01F);
  camera.pixel[kAmplifierRate] = 100.0F;
  auto intensities = torch::zeros({1, 3, 1, 1});
  intensities[0][1] = 0.1;
  intensities[0][2] = 0.1;
  // The inverse of the last pattern is black here, so that the level starts at 0.
  const auto counts = events_of(camera, intensities, torch::full({1, 1, 1}, 0.1)) * 0.01;
  const double step = std::log(11.0), left = std::exp(-1.04);
  EXPECT_NEAR(counts[0][0].item<double>(), step * (1.0 - left), 0.02);
  EXPECT_NEAR(counts[0][1].item<double>(), step * left * (1.0 - left), 0.02);
}

TEST(PixelModel, MismatchStaysWhenCyclesAreAveragedAndNoiseGoes) {
  torch::manual_seed(2);
  auto intensities = torch::zeros({1, 2, 128, 128});
  intensities.select(1, 1).fill_(0.1);
  const auto full = torch::full({1, 128, 128}, 0.5);
  auto noisy = ideal_camera(), unequal = ideal_camera();
  for (auto* camera : {&noisy, &unequal}) camera->pixel[kResetSpan] = 1.0F;
  noisy.pixel[kNoise] = 0.1F;
  unequal.pixel[kMismatch] = 0.1F;
  const auto spread = [&](const capture::SensorProfile& camera, size_t cycles) {
    return events_of(camera, intensities, full, cycles).std().item<double>();
  };
  EXPECT_LT(spread(noisy, 16), 0.3 * spread(noisy, 1));
  // ln(11) / 0.3 = 8 counts, of which a tenth is 0.8.
  EXPECT_GT(spread(unequal, 16), 0.7);
}

TEST(PixelModel, DarkEventsComeAtTheStatedRates) {
  torch::manual_seed(3);
  auto camera = ideal_camera();
  camera.pixel[kDarkOff] = 0.2F;
  camera.pixel[kDarkOn] = 0.1F;
  const auto counts = events_of(camera, torch::zeros({1, 2, 256, 256}), torch::zeros({1, 256, 256}));
  EXPECT_NEAR((counts < 0).to(torch::kFloat).mean().item<double>(), 0.2, 0.01);
  EXPECT_NEAR((counts > 0).to(torch::kFloat).mean().item<double>(), 0.1, 0.01);
}

TEST(PixelModel, TraitsAreOfTheSampleAndZeroForAnIdealPaperCamera) {
  capture::SensorProfile paper;
  paper.constants = {.eps = 0.01F, .tau = 0.3F, .sigma_w = 0.0F, .sigma_z = 0.0F};
  for (const float trait : capture::conditioning_vector(paper, 4)) EXPECT_EQ(trait, 0.0F);
  const auto sample = sample_of(ideal_camera(), 4, 4, 4, torch::kCPU);
  ASSERT_EQ(sample.conditioning.size(1), static_cast<int64_t>(capture::conditioning_size(4)));
  EXPECT_EQ(sample.conditioning[0][0].item<float>(), 1.0F);
  EXPECT_FLOAT_EQ(sample.conditioning[0][15].item<float>(), 0.5F);
}

}  // namespace
}  // namespace e2lf::learn
