// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <vector>

#include "e2lf/capture/profile/sensor_profile.h"

/// The physical pixel exists in four forms: for images of counts (sensor/pixel_model.h), for tensors with gradients
/// (learn/events/event_simulation.h), as probabilities (calibrate/count_distribution.h) and event by event
/// (streams/event_stream.h). A test named AgreesWithTheOtherFormsOfThePhysicalPixel compares each with the levels that
/// are computed here in small steps.
namespace e2lf::capture {

/// The light of one cycle: black and three patterns after the inverse of the last one, with 0.45 through the open
/// aperture.
inline constexpr double kFullLight = 0.45, kInverseLight = 0.25, kPatternLight[] = {0.0, 0.3, 0.05, 0.2};

/// Returns a camera with lag but without noise and mismatch, whose reference is at the level after black.
inline SensorProfile lagging_camera(float threshold) {
  using enum PixelConstant;
  SensorProfile camera;
  camera.event_model = "pixel";
  camera.pixel[kEps] = 0.01F;
  camera.pixel[kReceptorRate] = 30.0F;
  camera.pixel[kAmplifierRate] = 120.0F;
  camera.pixel[kThresholdOn] = camera.pixel[kThresholdOff] = threshold;
  camera.pixel[kBlackTime] = 0.0156F;
  camera.pixel[kLitTime] = 0.0104F;
  return camera;
}

/// Returns J = (I + eps) / eps of a light.
inline double exposure_of(double light, const PixelConstants& pixel) {
  return light / static_cast<double>(pixel[PixelConstant::kEps]) + 1.0;
}

/// Returns the level of the amplifier at the end of each pattern, or after a share of it. The photoreceptor follows
/// du/dt = K (J - exp u).
inline std::vector<double> pixel_levels(const PixelConstants& pixel, double share = 1.0) {
  using enum PixelConstant;
  constexpr int kSteps = 200000;
  double u = std::log(exposure_of(kInverseLight, pixel)), level = u;
  std::vector<double> levels;
  for (const double light : kPatternLight) {
    const auto seconds = static_cast<double>(pixel[levels.empty() ? kBlackTime : kLitTime]);
    const auto step = [&] {
      u += seconds / kSteps * static_cast<double>(pixel[kReceptorRate]) * (exposure_of(light, pixel) - std::exp(u));
    };
    const auto level_after = [&](double time) {
      return u + (level - u) * std::exp(-static_cast<double>(pixel[kAmplifierRate]) * time);
    };
    const auto steps_before = static_cast<int>(share * kSteps);
    for (int i = 0; i < steps_before; ++i) step();
    levels.push_back(level_after(share * seconds));
    for (int i = steps_before; i < kSteps; ++i) step();
    level = level_after(seconds);
  }
  return levels;
}

}  // namespace e2lf::capture
