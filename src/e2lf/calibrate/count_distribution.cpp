// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/count_distribution.h"

#include <array>
#include <cmath>
#include <numbers>

#include "e2lf/base/result.h"

namespace e2lf::calibrate {
namespace {

using enum capture::PixelConstant;

constexpr size_t kFirstGroup = 3, kLaterGroup = 2;
constexpr int kLeastAfterBlack = -4, kMostCount = 7;
constexpr int kLeastLater = -17;  // on the way back to black
constexpr size_t kThresholds = 21, kPoints = kThresholds * 2 * 8;
constexpr size_t kGrid = 24;                          // of the reference before a later group
constexpr double kThresholdReach = 3.2;               // standard deviations of the mismatch to either side
constexpr double kLeastProbability = 1e-5 / kPoints;  // of a path, with the weight of its point
constexpr double kLeastNoise = 1e-3;                  // of the log intensity, so that probabilities change smoothly

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

double tail(double distance, double noise) {
  const double value = distance / noise;
  return value < -6.0 ? 0.0 : value > 6.0 ? 1.0 : normal_cdf(value);
}

/// The thresholds of a pixel, and the share of such pixels.
struct Thresholds {
  double on = 0.0, off = 0.0, weight = 0.0;
};

/// A reference of a pixel with its probability.
struct Reference {
  double value = 0.0, weight = 0.0;
};

/// The quantities on which the counts of one transition depend, except for the reference.
struct Step {
  double level = 0.0, noise = 0.0, dark_off = 0.0, dark_on = 0.0;

  [[nodiscard]] double undisturbed() const { return 1.0 - dark_off - dark_on; }
};

/// Counts jump with the threshold and the reference, so that randomly distributed points would be needed by the
/// thousands. Noise smooths the jumps enough for rules with few points: equidistant ones for the threshold, which needs
/// the most in bright areas, two for the difference between ON and OFF, and eight Gauss points for the reference.
std::vector<Thresholds> thresholds_of(const capture::PixelConstants& constants) {
  const double common = constants[kMismatch], own = constants[kMismatchEach], spread = std::hypot(common, own);
  // Two correlated normal draws with the same standard deviation; ON and OFF share the common part.
  const double shared = spread > 0.0 ? common * common / (spread * spread) : 0.0;
  const double rest = std::sqrt(std::max(0.0, 1.0 - shared * shared));
  std::vector<Thresholds> all;
  double sum = 0.0;
  for (size_t i = 0; i < kThresholds; ++i) {
    const double both = kThresholdReach * (2.0 * static_cast<double>(i) / (kThresholds - 1) - 1.0);
    for (const double side : {-1.0, 1.0}) {
      const double other = shared * both + rest * side;
      all.push_back({constants[kThresholdOn] * std::max(1.0 + spread * both, capture::kLeastThreshold),
                     constants[kThresholdOff] * std::max(1.0 + spread * other, capture::kLeastThreshold),
                     std::exp(-0.5 * both * both)});
      sum += all.back().weight;
    }
  }
  for (Thresholds& each : all) each.weight /= sum;
  return all;
}

/// Returns the references after black, which are distributed evenly over a range.
std::vector<Reference> references_after_black(const capture::PixelConstants& constants, const Thresholds& thresholds,
                                              double black) {
  constexpr std::array<double, 4> kPlaces = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                             0.9602898564975363};
  constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                              0.1012285362903763};
  std::vector<Reference> references;
  for (const double side : {-1.0, 1.0}) {
    for (size_t k = 0; k < kPlaces.size(); ++k) {
      const double draw = 0.5 + 0.5 * side * kPlaces[k];
      references.push_back({black + thresholds.off * constants[kResetSpan] * draw - constants[kResetOffset],
                            0.5 * kWeights[k] * thresholds.weight});
    }
  }
  return references;
}

/// The counts of one sign in a transition.
struct Side {
  int sign;
  double threshold, other_threshold;
  double distance;  ///< of the level in this direction
  double beyond;    ///< the probability of at least one event
  double dark, other_dark;
};

/// Calls visit(count, next reference, probability) for all counts of one sign. A spurious event leads to the same
/// reference as one more event caused by the level, so both cases are visited together.
template <typename Visit>
void visit_side(const Step& step, const Side& side, double reference, double silent, double least, const Visit& visit) {
  constexpr int kLongest = 100;  // an upper bound of counts for realistic thresholds
  double beyond = side.beyond, one_less = silent;
  for (int count = 1; count < kLongest; ++count) {
    const double dark = one_less * side.dark;
    if (beyond + dark <= least) break;
    const double further = tail(side.distance - (count + 1) * side.threshold, step.noise);
    const double here = beyond - further;
    const double next = reference + side.sign * count * side.threshold;
    visit(side.sign * count, next, here * step.undisturbed() + dark);
    visit(side.sign * (count - 1), next - side.sign * side.other_threshold, here * side.other_dark);
    beyond = further;
    one_less = here;
  }
}

/// Calls visit(count, next reference, probability) for the outcomes of a transition that are more likely than `least`.
template <typename Visit>
void visit_outcomes(const Step& step, const Thresholds& pixel, double reference, double least, const Visit& visit) {
  const double distance = step.level - reference;
  const double on = tail(distance - pixel.on, step.noise), off = tail(-distance - pixel.off, step.noise);
  const double silent = 1.0 - on - off;
  visit(0, reference, silent * step.undisturbed());
  visit_side(step, {1, pixel.on, pixel.off, distance, on, step.dark_on, step.dark_off}, reference, silent, least,
             visit);
  visit_side(step, {-1, pixel.off, pixel.on, -distance, off, step.dark_off, step.dark_on}, reference, silent, least,
             visit);
}

/// Follows the counts of one pixel through a group along every path and accumulates their probabilities.
class Paths {
 public:
  Paths(std::span<const Step> steps, const CountGroup& group, const Thresholds& pixel, std::span<double> result)
      : steps_(steps), group_(group), pixel_(pixel), result_(result) {}

  // NOLINTNEXTLINE(misc-no-recursion): as deep as the group has transitions
  void follow(size_t n, double reference, double probability, size_t cell) {
    if (std::abs(probability) <= kLeastProbability) return;
    if (n == group_.transitions) {
      result_[group_.begin + cell] += probability;
      return;
    }
    visit_outcomes(steps_[group_.first + n], pixel_, reference, kLeastProbability / std::abs(probability),
                   [&](int count, double next, double share) {
                     follow(n + 1, next, probability * share, cell * group_.num_counts + group_.place_of(count));
                   });
  }

 private:
  std::span<const Step> steps_;
  const CountGroup& group_;
  const Thresholds& pixel_;
  std::span<double> result_;
};

/// Returns the references after a transition on a grid around its level. Each is divided over three places such that
/// its mean and its square are preserved, since otherwise each transition would widen their distribution.
std::vector<Reference> after(const Step& step, const Thresholds& pixel, const std::vector<Reference>& before) {
  const double below = pixel.on + 0.5 * pixel.off + 3.0 * step.noise;
  const double above = pixel.off + 0.5 * pixel.on + 3.0 * step.noise;
  const double spacing = (below + above) / (kGrid - 1);
  std::vector<Reference> grid(kGrid);
  for (size_t i = 0; i < kGrid; ++i) grid[i].value = step.level - below + spacing * static_cast<double>(i);
  for (const Reference& reference : before) {
    if (std::abs(reference.weight) <= kLeastProbability) continue;
    visit_outcomes(step, pixel, reference.value, kLeastProbability / std::abs(reference.weight),
                   [&](int, double next, double share) {
                     const double place = std::clamp((next - grid[0].value) / spacing, 1.0, kGrid - 2.0);
                     const double middle = std::round(place), apart = place - middle;
                     const double weight = reference.weight * share;
                     const auto i = static_cast<size_t>(middle);
                     grid[i - 1].weight += weight * 0.5 * (apart * apart - apart);
                     grid[i].weight += weight * (1.0 - apart * apart);
                     grid[i + 1].weight += weight * 0.5 * (apart * apart + apart);
                   });
  }
  return grid;
}

/// Computes the levels after black and after each later pattern; see sensor/pixel_model.h for the equations.
double follow_light(const capture::PixelConstants& constants, const PixelLight& light, std::vector<Step>& steps) {
  const size_t num_codes = light.is_whole ? light.of_patterns.size() / 2 : light.of_patterns.size();
  double inverse_level = 1.0 / light.inverse, level = std::log(light.inverse), black = 0.0;
  for (size_t n = 0; n < light.of_patterns.size(); ++n) {
    const double intensity = light.of_patterns[n], seconds = constants[n % num_codes == 0 ? kBlackTime : kLitTime];
    const double target = 1.0 / intensity;
    inverse_level = target + (inverse_level - target) * std::exp(-constants[kReceptorRate] * seconds * intensity);
    const double receptor = -std::log(inverse_level);
    level = receptor + (level - receptor) * std::exp(-constants[kAmplifierRate] * seconds);
    if (n == 0) {
      black = level;
    } else if (n == 2 * num_codes) {
      // Noise lowers the reference along with the level. The last reference has a grid, which is smoothed.
      const double spacing = 1.5 * (constants[kThresholdOn] + constants[kThresholdOff]) / (kGrid - 1);
      steps.push_back({level - constants[kResetOffset], std::max(0.5 * spacing, kLeastNoise), 0.0, 0.0});
    } else {
      const double fixed = constants[kNoise], shot = constants[kShotNoise];
      steps.push_back({level, std::max(std::sqrt(fixed * fixed + shot * shot / intensity), kLeastNoise),
                       std::min(constants[kDarkOff] / intensity, 0.5), std::min(constants[kDarkOn] / intensity, 0.5)});
    }
  }
  return black;
}

}  // namespace

size_t CountGroup::size() const {
  size_t cells = 1;
  for (size_t n = 0; n < transitions; ++n) cells *= num_counts;
  return cells;
}

std::vector<CountGroup> count_groups(size_t transitions) {
  std::vector<CountGroup> groups;
  for (size_t first = 0, begin = 0; first < transitions;) {
    const int least = first == 0 ? kLeastAfterBlack : kLeastLater;
    groups.push_back({first, std::min(first == 0 ? kFirstGroup : kLaterGroup, transitions - first), least,
                      static_cast<size_t>(kMostCount - least + 1), begin});
    first += groups.back().transitions;
    begin += groups.back().size();
  }
  return groups;
}

size_t histogram_size(size_t transitions) {
  size_t size = 0;
  for (const CountGroup& group : count_groups(transitions)) size += group.size();
  return size;
}

void count_distribution(const capture::PixelConstants& constants, const PixelLight& light, std::span<double> result) {
  E2LF_REQUIRE(light.of_patterns.size() >= 2, "black and at least one other pattern");
  const std::vector<CountGroup> groups = count_groups(light.of_patterns.size() - 1);
  E2LF_REQUIRE(result.size() == groups.back().begin + groups.back().size(), "the histogram fits the patterns");
  std::fill(result.begin(), result.end(), 0.0);
  std::vector<Step> steps;
  const double black = follow_light(constants, light, steps);
  for (const Thresholds& pixel : thresholds_of(constants)) {
    std::vector<Reference> references = references_after_black(constants, pixel, black);
    for (const CountGroup& group : groups) {
      Paths paths(steps, group, pixel, result);
      for (const Reference& reference : references) paths.follow(0, reference.value, reference.weight, 0);
      if (&group == &groups.back()) break;
      for (size_t n = group.first; n < group.first + group.transitions; ++n) {
        references = after(steps[n], pixel, references);
      }
    }
  }
  for (double& probability : result) probability = std::max(probability, 0.0);
}

}  // namespace e2lf::calibrate
