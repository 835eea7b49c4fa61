// SPDX-License-Identifier: MIT
#include "e2lf/learn/events/pixel_model.h"

#include <vector>

namespace e2lf::learn {
namespace {

using enum capture::PixelConstant;

constexpr double kLeastThreshold = 0.3;  // lower limit of a pixel's threshold, relative to the mean

/// The state of all pixels between patterns.
struct PixelState {
  torch::Tensor inverse_level;  ///< w = exp(-u) for the log intensity u of the photoreceptor
  torch::Tensor level;          ///< level of the amplifier, a log of (I + eps) / eps
  torch::Tensor reference;
};

/// Advances the state by `seconds` at the intensity J = (I + eps) / eps.
void follow(const torch::Tensor& intensity, const torch::Tensor& seconds, const PixelSamples& samples,
            PixelState& state) {
  const auto target = intensity.reciprocal();
  const auto decay = torch::exp(-samples.at(kReceptorRate) * seconds * intensity);
  state.inverse_level = target + (state.inverse_level - target) * decay;
  const auto log_intensity = -torch::log(state.inverse_level);
  const auto amplifier_decay = torch::exp(-samples.at(kAmplifierRate) * seconds);
  state.level = log_intensity + (state.level - log_intensity) * amplifier_decay;
}

/// Computes the events at the end of one pattern and moves the reference accordingly.
torch::Tensor compare(const torch::Tensor& level, const torch::Tensor& on, const torch::Tensor& off,
                      torch::Tensor& reference) {
  const auto difference = level - reference;
  const auto threshold = torch::where(difference > 0, on, off);
  const auto steps = difference / threshold;
  const auto count = steps + (steps.trunc() - steps).detach();
  reference = reference + threshold * count;
  return count;
}

/// Draws spurious events, which are rarer in brighter pixels, and moves the reference accordingly.
torch::Tensor dark_events(const torch::Tensor& intensity, const torch::Tensor& on, const torch::Tensor& off,
                          const PixelSamples& samples, torch::Tensor& reference) {
  const auto draw = torch::rand_like(intensity);
  const auto is_off = (draw * intensity < samples.at(kDarkOff)).to(intensity.scalar_type());
  const auto is_on = ((1.0 - draw) * intensity < samples.at(kDarkOn)).to(intensity.scalar_type());
  reference = reference - is_off * off + is_on * on;
  return is_on - is_off;
}

/// Computes the events of one active pattern.
torch::Tensor noisy_events(const torch::Tensor& intensity, const torch::Tensor& on, const torch::Tensor& off,
                           const PixelSamples& samples, PixelState& state) {
  const auto noise = torch::sqrt(samples.at(kNoise).square() + samples.at(kShotNoise).square() / intensity);
  const auto count = compare(state.level + noise * torch::randn_like(intensity), on, off, state.reference);
  return count + dark_events(intensity, on, off, samples, state.reference);
}

/// Returns the light J = (I + eps) / eps of each pattern, followed by that of the last code's inverse.
std::vector<torch::Tensor> shown_light(const torch::Tensor& intensities, const torch::Tensor& full,
                                       const PixelSamples& samples) {
  const int64_t num_patterns = intensities.size(1), num_codes = samples.transmission.size(1);
  const auto eps = samples.at(kEps), leak = samples.at(kLeak);
  std::vector<torch::Tensor> codes, inverses;
  for (int64_t n = 0; n < num_codes; ++n) {
    const auto open = intensities.select(1, n);
    const auto passed = open * samples.transmission.select(1, n).reshape({-1, 1, 1});
    codes.push_back((passed + leak * (full - open)) / eps + 1.0);
    inverses.push_back((full - passed).clamp_min(0.0) / eps + 1.0);
  }
  std::vector<torch::Tensor> shown = codes;
  if (num_patterns == 2 * num_codes + 1) {
    shown.insert(shown.end(), inverses.begin(), inverses.end());
    shown.push_back(codes.front());
  }
  shown.push_back(inverses.back());
  return shown;
}

}  // namespace

torch::Tensor simulate_pixel_events(const torch::Tensor& intensities, const torch::Tensor& full,
                                    const PixelSamples& samples) {
  const int64_t num_patterns = intensities.size(1), num_codes = samples.transmission.size(1);
  const std::vector<torch::Tensor> shown = shown_light(intensities, full, samples);
  const auto inverse = shown.back();

  const auto common = 1.0 + samples.at(kMismatch) * torch::randn_like(full);
  const auto threshold = [&](capture::PixelConstant mean) {
    const auto own = common + samples.at(kMismatchEach) * torch::randn_like(full);
    return samples.at(mean) * own.clamp_min(kLeastThreshold);
  };
  const auto on = threshold(kThresholdOn), off = threshold(kThresholdOff);

  PixelState start{inverse.reciprocal(), torch::log(inverse), {}};
  follow(shown[0], samples.at(kBlackTime), samples, start);
  std::vector<torch::Tensor> sums(static_cast<size_t>(num_patterns - 1));
  for (int64_t cycle = 0; cycle < samples.cycles; ++cycle) {
    PixelState state = start;
    state.reference = state.level + off * samples.at(kResetSpan) * torch::rand_like(full) - samples.at(kResetOffset);
    for (int64_t n = 1; n < num_patterns; ++n) {
      const auto& intensity = shown[static_cast<size_t>(n)];
      // The black pattern and its inverse are shown longer than the others.
      follow(intensity, samples.at(n % num_codes == 0 ? kBlackTime : kLitTime), samples, state);
      auto count = n == 2 * num_codes ? compare(state.level - samples.at(kResetOffset), on, off, state.reference)
                                      : noisy_events(intensity, on, off, samples, state);
      auto& sum = sums[static_cast<size_t>(n - 1)];
      sum = sum.defined() ? sum + count : count;
    }
  }
  return torch::stack(sums, 1) / static_cast<double>(samples.cycles);
}

}  // namespace e2lf::learn
