// SPDX-License-Identifier: MIT
#include "e2lf/recon/scene_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/recon/inversion.h"

namespace e2lf::recon {
namespace {

constexpr size_t kLocalMeanPx = 8;  // radius
constexpr float kTau = capture::SensorConstants{}.tau;

/// Returns the sum of the intensities of a pattern and its inverse, [y, x], relative to the intensity of black; `code`
/// is 0 for a1, and `tau` is the change of the log intensity that each count stands for.
std::vector<float> intensity_of_both(const capture::EventImages& whole_cycle, size_t code, float tau) {
  const size_t num_codes = whole_cycle.count / 2;
  std::vector<float> log_intensity(whole_cycle.image_size(), 0.0F), sum(whole_cycle.image_size(), 0.0F);
  for (size_t n = 0; n < num_codes + code; ++n) {
    const auto image = whole_cycle.image(n);
    for (size_t i = 0; i < sum.size(); ++i) log_intensity[i] += tau * image[i];
    // Image n ends with pattern n + 1 of the whole cycle, the inverses of which follow the N patterns.
    if (n + 1 != code && n + 1 != num_codes + code) continue;
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += std::exp(log_intensity[i]);
  }
  return sum;
}

/// Returns true if the rounding of counts explains the differences: hardly any exceeds a threshold, and in small images
/// no more than three standard deviations above this share. Without noise, the errors of rounding follow the shades of
/// the scene, so that neighbouring pixels are correlated. The mean of equal cycles has the rounding of one of them.
bool is_rounding(const std::vector<float>& difference) {
  constexpr double kFew = 0.0005, kDeviations = 3;
  const auto large = std::count_if(difference.begin(), difference.end(), [](float d) { return std::abs(d) > kTau; });
  const double usual = kFew * static_cast<double>(difference.size());
  return static_cast<double>(large) <= usual + kDeviations * std::sqrt(usual);
}

/// Subtracts the mean of the square around each pixel, which holds what slow pixels leave of smooth areas.
void subtract_local_mean(std::vector<float>& plane, size_t height, size_t width) {
  const std::vector<float> sums = box_sums(plane, height, width, kLocalMeanPx);
  constexpr float kArea = (2 * kLocalMeanPx + 1) * (2 * kLocalMeanPx + 1);
  for (size_t i = 0; i < plane.size(); ++i) plane[i] -= sums[i] / kArea;
}

/// Returns the mean of the correlations between each pixel and its neighbours on the right and below.
double neighbour_correlation(const std::vector<float>& plane, size_t height, size_t width) {
  double squares = 0, right = 0, below = 0;
  for (size_t y = 0; y < height; ++y) {
    const float* row = &plane[y * width];
    for (size_t x = 0; x < width; ++x) {
      const double value = row[x];
      squares += value * value;
      if (x + 1 < width) right += value * row[x + 1];
      if (y + 1 < height) below += value * row[x + width];
    }
  }
  return squares > 0 ? (right + below) / (2 * squares) : 0;
}

}  // namespace

double scene_motion(const capture::EventImages& whole_cycle, size_t cycles) {
  E2LF_REQUIRE(cycles >= 1, "sums of at least one cycle");
  const size_t num_codes = whole_cycle.count / 2;
  if (whole_cycle.count % 2 != 0 || num_codes < 3) return 0;
  const float tau = kTau / static_cast<float>(cycles);
  std::vector<float> difference = intensity_of_both(whole_cycle, num_codes - 2, tau);
  const std::vector<float> last = intensity_of_both(whole_cycle, num_codes - 1, tau);
  for (size_t i = 0; i < last.size(); ++i) difference[i] = std::log(difference[i] / last[i]);
  if (is_rounding(difference)) return 0;
  subtract_local_mean(difference, whole_cycle.height, whole_cycle.width);
  return neighbour_correlation(difference, whole_cycle.height, whole_cycle.width);
}

capture::EventImages lit_transitions(const capture::EventImages& whole_cycle) {
  capture::EventImages lit(whole_cycle.count / 2 - 1, whole_cycle.height, whole_cycle.width);
  std::copy_n(whole_cycle.values.begin(), lit.values.size(), lit.values.begin());
  return lit;
}

}  // namespace e2lf::recon
