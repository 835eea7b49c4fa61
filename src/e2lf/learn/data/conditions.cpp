// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/conditions.h"

#include <algorithm>
#include <cmath>

namespace e2lf::learn {
namespace {

/// Draws each constant of the camera from its uncertainty, and sets a transmission for every active pattern.
capture::SensorProfile draw_camera(capture::SensorProfile camera, const SensorConfig& sensor, size_t num_codes,
                                   Draws& draws) {
  const double spread = draws.chance(sensor.camera_nominal_share) ? 0.0 : sensor.camera_spread;
  const auto vary = [&](float value, float uncertainty) {
    return value * static_cast<float>(std::exp(draws.uniform(-1.0, 1.0) * spread * uncertainty));
  };
  for (size_t i = 0; i < camera.pixel.values.size(); ++i) {
    camera.pixel.values[i] = vary(camera.pixel.values[i], camera.uncertainty.values[i]);
  }
  camera.transmission.resize(num_codes - 1, 1.0F);
  for (size_t k = 1; k < camera.transmission.size(); ++k) {
    camera.transmission[k] = vary(camera.transmission[k], camera.transmission_uncertainty);
  }
  using enum capture::PixelConstant;
  camera.constants.eps = camera.pixel[kEps];
  camera.constants.tau = 0.5F * (camera.pixel[kThresholdOn] + camera.pixel[kThresholdOff]);
  return camera;
}

/// Draws a camera that is better than the stated one: each group of its imperfections is unchanged with probability
/// 1/2, and is otherwise reduced, down to none. Rates increase by a factor of up to 1000, which leaves no lag.
capture::SensorProfile draw_wide(capture::SensorProfile camera, Draws& draws) {
  using enum capture::PixelConstant;
  const auto scale = [&](std::initializer_list<capture::PixelConstant> names, double factor) {
    for (const auto name : names) camera.pixel[name] *= static_cast<float>(factor);
  };
  if (draws.chance(0.5)) scale({kReceptorRate, kAmplifierRate}, draws.log_uniform(1.0, 1000.0));
  if (draws.chance(0.5)) scale({kMismatch, kMismatchEach}, draws.uniform(0.0, 1.0));
  if (draws.chance(0.5)) scale({kNoise, kShotNoise, kDarkOff, kDarkOn}, draws.uniform(0.0, 1.0));
  if (draws.chance(0.5)) scale({kLeak}, draws.uniform(0.0, 1.0));
  return camera;
}

/// Draws the transmissions of black and of the active patterns at one position of the image; they deviate from those
/// that the network receives.
std::vector<float> draw_field(const std::vector<float>& stated, double spread, Draws& draws) {
  std::vector<float> passed = {1.0F};
  for (const float share : stated)
    passed.push_back(share * static_cast<float>(std::exp(spread * draws.uniform(-1.0, 1.0))));
  return passed;
}

}  // namespace

Conditions draw_conditions(const SensorConfig& sensor, uint64_t batch, torch::Device device, Draws& draws) {
  std::vector<float> gain, residue, tau, sigma_w, sigma_z;
  for (uint64_t i = 0; i < batch; ++i) {
    const bool nominal = draws.chance(sensor.nominal_share);
    const bool noise_free = draws.chance(sensor.noise_free_share) && !nominal;
    const auto pick = [&](float usual, const std::array<double, 2>& range) {
      const auto drawn = static_cast<float>(draws.uniform(range[0], range[1]));
      return nominal ? usual : drawn;
    };
    const float noise = noise_free ? 0.0F : 1.0F;
    tau.push_back(pick(sensor.nominal.tau, sensor.tau));
    sigma_w.push_back(noise * pick(sensor.nominal.sigma_w, sensor.sigma_w));
    sigma_z.push_back(noise * pick(sensor.nominal.sigma_z, sensor.sigma_z));
    const bool full = draws.chance(sensor.full_gain_share);
    const auto drawn_gain = static_cast<float>(draws.log_uniform(sensor.gain[0], sensor.gain[1]));
    gain.push_back(full ? 1.0F : drawn_gain);
    // Half of the residues are one threshold, as the change to black leaves them, the others a fraction of one.
    const double thresholds = std::min(1.0, draws.uniform(0.0, 2.0));
    residue.push_back(draws.chance(sensor.residue_share) && !nominal ? static_cast<float>(thresholds) : 0.0F);
  }
  const auto on_device = [&](const std::vector<float>& values) {
    return torch::tensor(at::ArrayRef<float>(values)).reshape({-1, 1, 1}).to(device);
  };
  return {on_device(gain).flatten(),
          on_device(residue).flatten(),
          {torch::full({static_cast<int64_t>(gain.size()), 1, 1}, sensor.nominal.eps, torch::device(device)),
           on_device(tau), on_device(sigma_w), on_device(sigma_z)}};
}

void add_conditioning(size_t num_patterns, Conditions& conditions) {
  const auto device = conditions.gain.device();
  if (num_patterns < 2) {
    conditions.constants.conditioning = torch::zeros({conditions.gain.size(0), 0}, torch::device(device));
    return;
  }
  const SampleConstants& constants = conditions.constants;
  const auto value = [](const torch::Tensor& values, int64_t i) { return values.flatten()[i].item<float>(); };
  std::vector<torch::Tensor> rows;
  for (int64_t i = 0; i < conditions.gain.size(0); ++i) {
    const auto conditioning =
        capture::conditioning_vector({.constants = {value(constants.eps, i), value(constants.tau, i),
                                                    value(constants.sigma_w, i), value(constants.sigma_z, i)},
                                      .residue = value(conditions.residue, i)},
                                     num_patterns);
    rows.push_back(torch::tensor(at::ArrayRef<float>(conditioning)));
  }
  conditions.constants.conditioning = torch::stack(rows).to(device);
}

void apply_camera(const SensorConfig& sensor, const capture::SensorProfile& camera, const PatternNumbers& patterns,
                  size_t cycles, Draws& draws, Conditions& conditions) {
  const auto device = conditions.gain.device();
  const auto row = [&](const std::vector<float>& values) { return torch::tensor(at::ArrayRef<float>(values)); };
  std::vector<torch::Tensor> constants, transmissions, is_pixel;
  for (int64_t i = 0; i < conditions.gain.size(0); ++i) {
    capture::SensorProfile drawn = draw_camera(camera, sensor, patterns.codes, draws);
    if (draws.chance(sensor.camera_wide_share)) drawn = draw_wide(std::move(drawn), draws);
    const bool chosen = draws.chance(sensor.camera_share);
    const auto gain = static_cast<float>(draws.log_uniform(sensor.camera_gain[0], sensor.camera_gain[1]));
    is_pixel.push_back(torch::tensor(chosen));
    constants.push_back(row({drawn.pixel.values.begin(), drawn.pixel.values.end()}));
    transmissions.push_back(row(draw_field(drawn.transmission, sensor.camera_field_spread, draws)));
    if (!chosen) continue;
    conditions.gain[i] = gain;
    conditions.constants.eps[i] = drawn.constants.eps;
    conditions.constants.tau[i] = drawn.constants.tau;
    conditions.constants.conditioning[i] = row(capture::conditioning_vector(drawn, patterns.all, cycles)).to(device);
  }
  conditions.constants.pixel = {torch::stack(is_pixel), torch::stack(constants).to(device),
                                torch::stack(transmissions).to(device), static_cast<int64_t>(cycles)};
}

}  // namespace e2lf::learn
