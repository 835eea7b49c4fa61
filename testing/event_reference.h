// SPDX-License-Identifier: MIT
// Plain scalar versions of sensor::coded_intensities() and sensor::simulate_events() on one thread, with the logarithm
// and trigonometry of the C library. Coded intensities are bit-identical (without fused multiply-add). Event counts are
// equal unless a quotient lies within rounding of a whole number (about one in a million).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "e2lf/base/rng.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::sensor {

inline float uniform(uint32_t word) {
  return (static_cast<float>(word) + 0.5F) * 0x1p-32F;
}

/// Computes CounterRng::normal2 from any two words.
inline std::array<float, 2> box_muller(uint32_t word0, uint32_t word1) {
  const float u0 = std::min(uniform(word0), 1.0F);
  const float radius = std::sqrt(-2.0F * std::log(u0));
  const float angle = static_cast<float>(word1) * (2.0F * std::numbers::pi_v<float> * 0x1p-32F);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

inline Result<CodedIntensities> reference_coded_intensities(const capture::Codes& codes,
                                                            const LightFieldView& light_field) {
  E2LF_RETURN_IF_ERROR(check_fit(codes, light_field));
  const lightfield::Shape shape = lightfield::shape_of(light_field);
  CodedIntensities intensities(codes.num_patterns, shape.height, shape.width);
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    for (size_t view = 0; view < shape.num_views(); ++view) {
      const float weight = codes.pattern(n)[view] / static_cast<float>(shape.num_views());
      const auto source = light_field[view / shape.views_x][view % shape.views_x];
      float* sum = intensities.image(n).data();
      for (size_t i = 0; i < shape.view_size(); ++i) sum[i] += weight * source.value(i);
    }
  }
  return intensities;
}

inline Result<capture::EventImages> reference_simulate_events(const CodedIntensities& intensities,
                                                              const EventModelOptions& options) {
  E2LF_RETURN_IF_ERROR(validate(options));
  E2LF_REQUIRE(intensities.count >= 2, "events need at least two patterns");
  const auto& [eps, tau, sigma_w, sigma_z, sigma_i] = options.constants;
  capture::EventImages images(intensities.count - 1, intensities.height, intensities.width);
  for (size_t pixel = 0; pixel < intensities.image_size(); ++pixel) {
    const auto log_intensity = [&, eps = eps](size_t n) {
      return std::log(std::max(0.0F, intensities.image(n)[pixel] * options.gain) + eps);
    };
    float reference = log_intensity(0);
    if (options.residue != 0.0F) {
      const float thresholds = options.residue * uniform(CounterRng(options.seed, kResidueStream).bits(pixel)[0]);
      reference += tau * thresholds;
    }
    for (size_t step = 0; step < images.count; ++step) {
      const auto words = CounterRng(options.seed, step / 2).bits(pixel);
      const auto [w, z] = box_muller(words[2 * (step % 2)], words[2 * (step % 2) + 1]);
      const float now = log_intensity(step + 1);
      const float threshold = std::max(tau + sigma_z * z, kMinThreshold);
      const float count = std::clamp(std::trunc((now - reference + sigma_w * w) / threshold), -32768.0F, 32767.0F);
      images.image(step)[pixel] = static_cast<int16_t>(count);
      reference = options.model == EventModel::kQuantised ? now : reference + tau * count;
    }
  }
  return images;
}

}  // namespace e2lf::sensor
