// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/calibrate.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>

#include "testing/test_still_scenes.h"

namespace e2lf::calibrate {
namespace {

using enum capture::PixelConstant;

/// A first guess that is off by a tenth and more.
capture::SensorProfile wrong_guess(capture::SensorProfile camera) {
  camera.pixel[kThresholdOn] *= 1.12F;
  camera.pixel[kThresholdOff] *= 0.9F;
  camera.pixel[kReceptorRate] *= 0.75F;
  camera.pixel[kAmplifierRate] *= 1.3F;
  camera.pixel[kMismatch] *= 1.3F;
  camera.pixel[kNoise] *= 0.8F;
  camera.transmission = {1.0F, 1.0F, 1.0F};
  camera.transmission_slope_x.clear();
  camera.transmission_slope_y.clear();
  return camera;
}

std::map<std::string, Estimate> by_key(const Calibration& calibration) {
  std::map<std::string, Estimate> estimates;
  for (const Estimate& each : calibration.estimates) estimates[each.key] = each;
  return estimates;
}

/// Keys of all constants but some, to hold.
std::vector<std::string> all_but(const capture::SensorProfile& camera, const std::vector<std::string>& free) {
  std::vector<std::string> keys;
  for (const Parameter& each : fit_parameters(3, camera, {}).value()) {
    if (std::ranges::find(free, each.key) == free.end()) keys.push_back(each.key);
  }
  return keys;
}

/// Calibrates from even patches behind known open areas, and asks for the constants within the tolerances of
/// docs/calibration.md.
void expect_recovered(const capture::SensorProfile& truth) {
  const capture::Codes codes = known_open_areas();
  const capture::SensorProfile guess = wrong_guess(truth);
  const auto found =
      calibrate({simulate(truth, patches(0.01F, 0.6F), 4, codes)}, codes, guess, {.held = {}, .is_even = true});
  ASSERT_TRUE(found) << found.error().text();
  const auto estimates = by_key(*found);
  const auto expect_within = [&](capture::PixelConstant constant, float share) {
    const auto* key = capture::pixel_constant_key(constant);
    const float value = found->camera.pixel[constant];
    if (estimates.at(key).is_determined) {
      EXPECT_NEAR(value / truth.pixel[constant], 1.0, share) << key;
    } else {
      EXPECT_EQ(value, guess.pixel[constant]) << key;
    }
  };
  for (const auto* key : {"threshold_on", "threshold_off", "mismatch", "receptor_rate_hz", "noise"}) {
    EXPECT_TRUE(estimates.at(key).is_determined) << key;
  }
  expect_within(kThresholdOn, 0.02F);
  expect_within(kThresholdOff, 0.02F);
  expect_within(kMismatch, 0.10F);
  expect_within(kReceptorRate, 0.15F);
  expect_within(kAmplifierRate, 0.15F);
  expect_within(kNoise, 0.10F);
  for (size_t n = 1; n < 3; ++n) {
    EXPECT_NEAR(found->camera.transmission[n], truth.transmission[n], 0.04);
    EXPECT_NEAR(found->camera.transmission_slope_x[n], truth.transmission_slope_x[n], 0.02);
    EXPECT_NEAR(found->camera.transmission_slope_y[n], truth.transmission_slope_y[n], 0.02);
  }
  for (const Agreement& row : found->agreement) {
    EXPECT_LT(row.total_variation, 0.01 + row.chance) << "at " << row.brightness;
  }
}

TEST(Calibrate, RecoversConstantsOverAGridFromKnownOpenAreas) {
  struct Truth {
    float threshold, receptor_rate, amplifier_rate, mismatch;
  };
  for (const Truth& each :
       {Truth{0.40F, 27.0F, 280.0F, 0.10F}, Truth{0.25F, 15.0F, 500.0F, 0.15F}, Truth{0.50F, 60.0F, 180.0F, 0.05F}}) {
    auto truth = plain_camera();
    truth.pixel[kThresholdOn] = each.threshold;
    truth.pixel[kThresholdOff] = 0.85F * each.threshold;
    truth.pixel[kReceptorRate] = each.receptor_rate;
    truth.pixel[kAmplifierRate] = each.amplifier_rate;
    truth.pixel[kMismatch] = each.mismatch;
    truth.transmission_slope_x = {0.0F, 0.06F, 0.08F};
    truth.transmission_slope_y = {0.0F, 0.02F, 0.06F};
    SCOPED_TRACE("threshold " + std::to_string(each.threshold));
    expect_recovered(truth);
  }
}

TEST(Calibrate, AllTransitionsDetermineMoreThanTheLitOnes) {
  const auto truth = plain_camera();
  const capture::Codes codes = known_open_areas(), whole = capture::whole_cycle(codes);
  auto guess = truth;
  guess.pixel[kThresholdOn] *= 1.12F;
  guess.pixel[kReceptorRate] *= 0.75F;
  guess.pixel[kAmplifierRate] *= 1.3F;
  const CalibrationOptions options{.held = all_but(guess, {"threshold_on", "receptor_rate_hz", "amplifier_rate_hz"}),
                                   .is_even = true};
  const auto field = patches(0.01F, 0.6F);
  const auto lit = calibrate({simulate(truth, field, 1, codes)}, codes, guess, options);
  const auto all = calibrate({simulate(truth, field, 1, whole)}, whole, guess, options);
  ASSERT_TRUE(lit && all);
  for (const auto* key : {"threshold_on", "receptor_rate_hz"}) {
    const Estimate of_lit = by_key(*lit).at(key), of_all = by_key(*all).at(key);
    ASSERT_TRUE(of_all.is_determined) << key;
    EXPECT_LT(of_all.high - of_all.low, of_lit.high - of_lit.low) << key;
  }
  EXPECT_NEAR(all->camera.pixel[kThresholdOn] / truth.pixel[kThresholdOn], 1.0, 0.02);
  EXPECT_EQ(all->agreement.front().measured.mean.size(), 8U);
}

TEST(Calibrate, SaysWhatABrightSceneDoesNotDetermineAndKeepsIt) {
  const auto truth = plain_camera();
  auto guess = truth;
  guess.pixel[kDarkOff] = 0.05F;
  guess.pixel[kLeak] = 0.0008F;
  guess.pixel[kReceptorRate] = 35.0F;
  const StillScene scene = simulate(truth, patches(30.0F, 50.0F), 1);
  const auto found = calibrate({scene}, capture::default_codes(), guess, {.held = {}, .is_even = true});
  ASSERT_TRUE(found) << found.error().text();
  const auto estimates = by_key(*found);
  EXPECT_FALSE(estimates.at("dark_off").is_determined);
  EXPECT_EQ(found->camera.pixel[kDarkOff], guess.pixel[kDarkOff]);
}

TEST(Calibrate, HoldsWhatItIsToldAndRefusesUnknownKeys) {
  const auto guess = wrong_guess(plain_camera());
  const StillScene scene = simulate(plain_camera(), patches(0.1F, 2.0F), 1);
  const auto refused = calibrate({scene}, capture::default_codes(), guess, {.held = {"threshold_onn"}});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text().find("threshold_on"), std::string::npos);
  capture::SensorProfile paper;
  EXPECT_EQ(calibrate({scene}, capture::default_codes(), paper, {}).error().code, ErrorCode::kInvalidValue);
  const StillScene black{{capture::EventImages(3, 64, 64)}};
  EXPECT_EQ(calibrate({black}, capture::Codes(3, 8, 8), guess, {}).error().code, ErrorCode::kShape);
}

TEST(Calibrate, MovesAConstantThatIsDeterminedToTheTruthAndWarnsOfTheJumpByName) {
  const auto truth = plain_camera();
  auto guess = truth;
  guess.pixel[kNoise] *= 1.5F;
  guess.uncertainty[kNoise] = 0.1F;
  const StillScene scene = simulate(truth, patches(0.1F, 2.0F), 1);
  const CalibrationOptions options{.held = all_but(guess, {"noise"}), .is_even = true};
  const auto found = calibrate({scene}, capture::default_codes(), guess, options);
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_NEAR(found->camera.pixel[kNoise] / truth.pixel[kNoise], 1.0, 0.1);
  ASSERT_EQ(found->warnings.size(), 1U);
  EXPECT_EQ(found->warnings[0].find("noise went from"), 0U) << found->warnings[0];

  const auto from_truth = calibrate({scene}, capture::default_codes(), truth, options);
  ASSERT_TRUE(from_truth);
  EXPECT_TRUE(from_truth->warnings.empty());
}

TEST(Calibrate, AnOrdinarySceneMovesThresholdsToTheTruthAndKeepsTheReceptorsRate) {
  const auto truth = plain_camera();
  auto guess = truth;
  guess.pixel[kReceptorRate] *= 0.8F;
  guess.pixel[kThresholdOn] *= 1.1F;
  guess.pixel[kThresholdOff] *= 0.9F;
  guess.uncertainty[kThresholdOn] = guess.uncertainty[kThresholdOff] = 0.1F;
  const auto found = calibrate({simulate(truth, patches(0.02F, 0.6F), 5)}, capture::default_codes(), guess, {});
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_EQ(found->camera.pixel[kReceptorRate], guess.pixel[kReceptorRate]);
  EXPECT_FALSE(by_key(*found).at("receptor_rate_hz").is_determined);
  for (const auto constant : {kThresholdOn, kThresholdOff}) {
    const float before = std::abs(guess.pixel[constant] / truth.pixel[constant] - 1.0F);
    EXPECT_LT(std::abs(found->camera.pixel[constant] / truth.pixel[constant] - 1.0F), 0.7F * before)
        << capture::pixel_constant_key(constant);
  }
}

TEST(FitParameters, SpreadAsTheStartingCameraStatesOrAsPlausible) {
  auto camera = plain_camera();
  camera.uncertainty[kThresholdOn] = 0.196F;
  camera.uncertainty[kResetSpan] = 0.392F;  // of a value of 1, fitted as it is
  camera.transmission_uncertainty = 0.098F;
  std::map<std::string, double> spreads;
  for (const Parameter& each : fit_parameters(3, camera, {}).value()) spreads[each.key] = each.spread;
  EXPECT_NEAR(spreads.at("threshold_on"), 0.1, 1e-6);
  EXPECT_NEAR(spreads.at("reset_span"), 0.2 * camera.pixel[kResetSpan], 1e-6);
  EXPECT_NEAR(spreads.at("transmission[1]"), 0.05, 1e-6);
  EXPECT_NEAR(spreads.at("transmission.slope_x[2]"), 0.05, 1e-6);
  EXPECT_EQ(spreads.at("threshold_off"), 0.2);
}

}  // namespace
}  // namespace e2lf::calibrate
