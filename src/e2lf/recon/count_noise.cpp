// SPDX-License-Identifier: MIT
#include "e2lf/recon/count_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace e2lf::recon {
namespace {

using capture::PixelConstant;

constexpr int kLevelsPerEvent = 4;  // of the table of log intensities
constexpr int kMostLevel = 64;      // in events; levels beyond have the variance of the last one
constexpr int kPerVariance = 16, kVariances = 64;
constexpr int kPerCount = 16, kMostCount = 6, kCounts = 2 * kMostCount * kPerCount + 1;
/// In the paper's models, the reciprocals of noisy thresholds and the residues of the references raise the variance
/// above the table by a fifth, as simulations of still scenes show. With physical pixels, the table is a fifth above
/// such simulations; this margin is kept for both, because scenes differ.
constexpr float kExcessOfPaper = 1.45F;

/// Returns the variance of the log intensity with which a cycle compares, at a level above black in logarithm.
float log_variance(const capture::SensorProfile& camera, float level) {
  if (!camera.is_pixel()) return camera.constants.sigma_w * camera.constants.sigma_w;
  const capture::PixelConstants& pixel = camera.pixel;
  const float noise = pixel[PixelConstant::kNoise], shot = pixel[PixelConstant::kShotNoise];
  const float dark = pixel[PixelConstant::kDarkOff] + pixel[PixelConstant::kDarkOn];
  const float threshold = pixel[PixelConstant::kThresholdOn];
  return noise * noise + (shot * shot + dark * threshold * threshold) * std::exp(-std::max(0.0F, level));
}

struct Moments {
  double mean = 0, square = 0;
};

/// Returns the moments of a normal variable that is truncated toward zero.
Moments of_truncated(double mean, double deviation) {
  Moments moments;
  for (int n = 1; n <= 2 * kMostCount; ++n) {  // sums of the probabilities to reach n and -n
    const double scale = deviation * std::numbers::sqrt2;
    const double above = 0.5 * std::erfc((n - mean) / scale), below = 0.5 * std::erfc((n + mean) / scale);
    moments.mean += above - below;
    moments.square += (2 * n - 1) * (above + below);
  }
  return moments;
}

/// Returns the variances of truncated counts by the variance of the noise and the mean count. The distance to the
/// reference has the mean of `residues` values that are evenly distributed over [0, 1); 0 = none.
std::vector<float> table_of(int residues) {
  constexpr double kStep = 1.0 / 16, kReach = kMostCount + 2;
  std::vector<float> table;
  for (int v = 0; v < kVariances; ++v) {
    const double deviation = std::sqrt((v + 0.5) / kPerVariance);
    std::vector<Moments> moments;
    for (double change = -kReach; change <= kReach; change += kStep) {
      Moments sum;
      for (int r = 0; r < std::max(residues, 1); ++r) {
        const Moments one = of_truncated(change + (residues == 0 ? 0 : (r + 0.5) / residues), deviation);
        sum.mean += one.mean / std::max(residues, 1);
        sum.square += one.square / std::max(residues, 1);
      }
      moments.push_back(sum);
    }
    size_t at = 0;  // the mean count grows with the change
    for (int c = 0; c < kCounts; ++c) {
      const double count = static_cast<double>(c) / kPerCount - kMostCount;
      while (at + 2 < moments.size() && moments[at + 1].mean < count) ++at;
      const double span = moments[at + 1].mean - moments[at].mean;
      const double share = span > 0 ? std::clamp((count - moments[at].mean) / span, 0.0, 1.0) : 0.0;
      const auto variance = [](const Moments& m) { return m.square - m.mean * m.mean; };
      table.push_back(static_cast<float>(std::lerp(variance(moments[at]), variance(moments[at + 1]), share)));
    }
  }
  return table;
}

}  // namespace

CountNoise::CountNoise(const capture::SensorProfile& camera)
    : is_pixel_(camera.is_pixel()),
      threshold_on_(is_pixel_ ? camera.pixel[PixelConstant::kThresholdOn] : camera.constants.tau),
      threshold_off_(is_pixel_ ? camera.pixel[PixelConstant::kThresholdOff] : camera.constants.tau),
      threshold_spread_(is_pixel_ ? 0 : camera.constants.sigma_z / camera.constants.tau),
      reference_variance_(0) {
  if (is_pixel_) {
    const float span = camera.pixel[PixelConstant::kResetSpan] * threshold_off_ / threshold_on_;
    reference_variance_ = span * span / 12;
  }
  for (int level = 0; level <= kMostLevel * kLevelsPerEvent; ++level) {
    log_variances_.push_back(log_variance(camera, threshold_on_ * static_cast<float>(level) / kLevelsPerEvent));
  }
  static const std::vector<float> kAtReference = table_of(0), kAboveReference = table_of(4);
  at_reference_ = kAtReference;
  above_reference_ = kAboveReference;
}

float CountNoise::truncated(float variance, float count, const PixelLevel& state) const {
  const bool has_residue = !is_pixel_ && state.variance >= 0;
  const std::vector<float>& table = has_residue ? above_reference_ : at_reference_;
  const int v = std::min(static_cast<int>(variance * kPerVariance), kVariances - 1);
  const float signed_count = has_residue && !state.is_below ? -count : count;
  const float place = std::clamp((signed_count + kMostCount) * kPerCount, 0.0F, kCounts - 1.0F);
  // Beyond the table, the variance grows with that of the noise.
  const float beyond = std::max(0.0F, variance - static_cast<float>(kVariances) / kPerVariance);
  return table[static_cast<size_t>(v) * kCounts + static_cast<size_t>(place + 0.5F)] + beyond;
}

float CountNoise::next(float count, PixelLevel& state) const {
  const float level = state.level + count;
  const auto at = static_cast<size_t>(std::clamp(level * kLevelsPerEvent, 0.0F, float{kMostLevel * kLevelsPerEvent}));
  const float threshold = count < 0 ? threshold_off_ : threshold_on_;
  const float spread = threshold_spread_ * count;
  const float after = log_variances_[at] / (threshold * threshold) + spread * spread;
  // The noise of the level before a transition is in its count, too, and noisy thresholds are made up for.
  const float noise = after + (state.variance < 0 ? reference_variance_ : state.variance);
  const float counted = truncated(noise, count, state);
  state = {level, after, count >= 0};
  return is_pixel_ ? counted : kExcessOfPaper * counted;
}

}  // namespace e2lf::recon
