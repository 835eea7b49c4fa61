// SPDX-License-Identifier: MIT
// Implements simulate_pixel_events() of event_simulation.h.
#include <vector>

#include "e2lf/learn/events/event_simulation.h"

namespace e2lf::learn {
namespace {

using enum capture::PixelConstant;

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

/// Adds spurious events, which are rarer in brighter pixels, to the counts. The reference moves when the pattern ends.
void add_dark_events(const torch::Tensor& intensity, const torch::Tensor& on, const torch::Tensor& off,
                     const PixelSamples& samples, torch::Tensor& reference, torch::Tensor& counts) {
  const auto draw = torch::rand_like(intensity);
  const auto is_off = (draw * intensity < samples.at(kDarkOff)).to(intensity.scalar_type());
  const auto is_on = ((1.0 - draw) * intensity < samples.at(kDarkOn)).to(intensity.scalar_type());
  reference = reference - is_off * off + is_on * on;
  counts = counts + (is_on - is_off);
}

torch::Tensor random_noise(const torch::Tensor& intensity, const PixelSamples& samples) {
  return torch::sqrt(samples.at(kNoise).square() + samples.at(kShotNoise).square() / intensity) *
         torch::randn_like(intensity);
}

/// Returns the light J = (I + eps) / eps of each pattern, followed by that of the last code's inverse.
std::vector<torch::Tensor> shown_light(const torch::Tensor& intensities, const torch::Tensor& full,
                                       const PixelSamples& samples) {
  const int64_t num_patterns = intensities.size(1), num_codes = samples.transmission.size(1);
  const auto eps = samples.at(kEps), leak = samples.at(kLeak);
  const bool is_whole = num_patterns == 2 * num_codes + 1, is_still = full.dim() == 3;
  const auto full_at = [&](int64_t n) { return is_still ? full : full.select(1, n); };
  std::vector<torch::Tensor> codes, inverses;
  for (int64_t n = 0; n < num_codes; ++n) {
    const auto open = intensities.select(1, n), transmission = samples.transmission.select(1, n).reshape({-1, 1, 1});
    const auto passed = open * transmission;
    codes.push_back((passed + leak * (full_at(n) - open)) / eps + 1.0);
    // If the scene moves, the inverse sees it later than the code.
    const int64_t later = num_codes + n;
    const auto blocked =
        is_still || !is_whole ? passed : transmission * (full_at(later) - intensities.select(1, later));
    inverses.push_back((full_at(is_still || !is_whole ? n : later) - blocked).clamp_min(0.0) / eps + 1.0);
  }
  std::vector<torch::Tensor> shown = codes;
  if (is_whole) {
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

  const auto common = 1.0 + samples.at(kMismatch) * torch::randn_like(inverse);
  const auto threshold = [&](capture::PixelConstant mean) {
    const auto own = common + samples.at(kMismatchEach) * torch::randn_like(inverse);
    return samples.at(mean) * own.clamp_min(capture::kLeastThreshold);
  };
  const auto on = threshold(kThresholdOn), off = threshold(kThresholdOff);

  PixelState start{inverse.reciprocal(), torch::log(inverse), {}};
  follow(shown[0], samples.at(kBlackTime), samples, start);
  std::vector<torch::Tensor> sums(static_cast<size_t>(num_patterns - 1));
  for (int64_t cycle = 0; cycle < samples.cycles; ++cycle) {
    PixelState state = start;
    state.reference = state.level + off * samples.at(kResetSpan) * torch::rand_like(inverse) - samples.at(kResetOffset);
    for (int64_t n = 1; n < num_patterns; ++n) {
      const auto& intensity = shown[static_cast<size_t>(n)];
      const bool is_to_black = n == 2 * num_codes;
      const auto noise = is_to_black ? -samples.at(kResetOffset) : random_noise(intensity, samples);
      // The black pattern and its inverse are shown longer than the others.
      const auto seconds = samples.at(n % num_codes == 0 ? kBlackTime : kLitTime);
      follow(intensity, seconds, samples, state);
      auto counts = compare(state.level + noise, on, off, state.reference);
      if (!is_to_black) add_dark_events(intensity, on, off, samples, state.reference, counts);
      auto& sum = sums[static_cast<size_t>(n - 1)];
      sum = sum.defined() ? sum + counts : counts;
    }
  }
  return torch::stack(sums, 1) / static_cast<double>(samples.cycles);
}

}  // namespace e2lf::learn
