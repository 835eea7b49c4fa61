// SPDX-License-Identifier: MIT
#include "e2lf/recon/gain.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace e2lf::recon {
namespace {

constexpr size_t kSamples = 1 << 18;
constexpr double kBrightQuantile = 0.995, kDarkQuantile = 0.005;
constexpr float kMostBlack = 0.15F;  ///< relative to the bright level; keeps the contrast of scenes without black

/// Returns a quantile of the finite values, or 0 if there are none.
float level_of(std::span<const float> values, double quantile) {
  // An odd stride visits the columns of an image evenly even if its width is a power of two.
  const size_t stride = values.size() / kSamples | 1;
  std::vector<float> samples;
  samples.reserve(values.size() / stride + 1);
  for (size_t i = 0; i < values.size(); i += stride) {
    if (std::isfinite(values[i])) samples.push_back(values[i]);
  }
  if (samples.empty()) return 0;
  const auto rank = static_cast<ptrdiff_t>(quantile * static_cast<double>(samples.size() - 1));
  std::nth_element(samples.begin(), samples.begin() + rank, samples.end());
  return samples[static_cast<size_t>(rank)];
}

}  // namespace

float auto_gain(const lightfield::LightField& light_field, float black) {
  const float level = level_of(light_field.data(), kBrightQuantile) - black;
  if (level <= 0 || (level >= 0.7F && level <= 1.0F)) return 1;
  return std::clamp(0.9F / level, 0.25F, 64.0F);
}

float auto_black(const lightfield::LightField& light_field) {
  const float bright = std::max(0.0F, level_of(light_field.data(), kBrightQuantile));
  return std::clamp(level_of(light_field.data(), kDarkQuantile), 0.0F, kMostBlack * bright);
}

void apply_tone(lightfield::LightField& light_field, float black, float gain) {
  if (black == 0.0F && gain == 1.0F) return;
  for (float& value : light_field.data()) value = gain * (value - black);
}

}  // namespace e2lf::recon
