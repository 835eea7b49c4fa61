// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/count_distribution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "e2lf/base/contract.h"

namespace e2lf::calibrate {
namespace {

using enum capture::PixelConstant;

constexpr size_t kThresholds = 21, kPoints = kThresholds * 2 * 8;
constexpr double kThresholdReach = 3.2;               // standard deviations of the mismatch to either side
constexpr double kLeastProbability = 1e-5 / kPoints;  // of a path, with the weight of its point
constexpr double kLeastThreshold = 0.3;               // relative to the mean threshold, as in the simulation
constexpr double kLeastNoise = 1e-3;                  // of the log intensity, so that probabilities change smoothly

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

/// Two standard normal draws and a uniform one in 0..1, with the weight of the point.
struct Point {
  double both = 0.0, other = 0.0, reset = 0.0, weight = 0.0;
};

/// Counts jump with the threshold and the reference, so that randomly distributed points would be needed by the
/// thousands. Noise smooths the jumps enough for rules with few points: equidistant ones for the threshold, which needs
/// the most in bright areas, two for the difference between ON and OFF, and eight Gauss points for the reference.
std::array<Point, kPoints> make_points() {
  constexpr std::array<double, 4> kPlaces = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                             0.9602898564975363};
  constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                              0.1012285362903763};
  std::array<Point, kPoints> points;
  double sum = 0.0;
  size_t place = 0;
  for (size_t i = 0; i < kThresholds; ++i) {
    const double both = kThresholdReach * (2.0 * static_cast<double>(i) / (kThresholds - 1) - 1.0);
    for (const double other : {-1.0, 1.0}) {
      for (const double side : {-1.0, 1.0}) {
        for (size_t k = 0; k < kPlaces.size(); ++k) {
          points[place] = {both, other, 0.5 + 0.5 * side * kPlaces[k], kWeights[k] * std::exp(-0.5 * both * both)};
          sum += points[place++].weight;
        }
      }
    }
  }
  for (Point& point : points) point.weight /= sum;
  return points;
}

/// The quantities on which the counts of one transition depend, except for the reference.
struct Step {
  double level = 0.0, noise = 0.0, dark_off = 0.0, dark_on = 0.0;

  [[nodiscard]] double undisturbed() const { return 1.0 - dark_off - dark_on; }
};

/// Follows the counts of one pixel along every path and accumulates their probabilities.
class Paths {
 public:
  Paths(std::span<const Step> steps, std::span<double> result) : steps_(steps), result_(result) {}

  void follow(double on, double off, double reference, double weight) {
    on_ = on;
    off_ = off;
    go(0, reference, weight, 0);
  }

 private:
  void go(size_t n, double reference, double probability, size_t cell) {
    if (probability <= kLeastProbability) return;
    if (n == steps_.size()) {
      result_[cell] += probability;
      return;
    }
    const Step& step = steps_[n];
    const double distance = step.level - reference;
    const double on = tail(distance - on_, step.noise), off = tail(-distance - off_, step.noise);
    const Place place{reference, probability, (1.0 - on - off) * probability, cell};
    go(n + 1, reference, place.silent * step.undisturbed(), next_cell(cell, 0));
    go_on(n, {1, on_, off_, distance, on, step.dark_on, step.dark_off}, place);
    go_on(n, {-1, off_, on_, -distance, off, step.dark_off, step.dark_on}, place);
  }

  struct Place {
    double reference, probability;
    double silent;  ///< probability that the level caused no event
    size_t cell;
  };

  struct Side {
    int sign;
    double threshold, other_threshold;
    double distance;  ///< of the level in this direction
    double beyond;    ///< the probability of at least one event
    double dark, other_dark;
  };

  /// Follows all counts of one sign. A spurious event leads to the same reference as one more event caused by the
  /// level, so both cases are followed together.
  void go_on(size_t n, const Side& side, const Place& place) {
    const Step& step = steps_[n];
    double beyond = side.beyond, one_less = place.silent;
    for (int count = 1; count < kLongest; ++count) {
      const double dark = one_less * side.dark;
      if (beyond * place.probability + dark <= kLeastProbability) break;
      const double further = tail(side.distance - (count + 1) * side.threshold, step.noise);
      const double here = place.probability * (beyond - further);
      const double reference = place.reference + side.sign * count * side.threshold;
      go(n + 1, reference, here * step.undisturbed() + dark, next_cell(place.cell, side.sign * count));
      go(n + 1, reference - side.sign * side.other_threshold, here * side.other_dark,
         next_cell(place.cell, side.sign * (count - 1)));
      beyond = further;
      one_less = here;
    }
  }

  static size_t next_cell(size_t cell, int count) { return cell * kNumCounts + count_place(count); }

  static double tail(double distance, double noise) {
    const double value = distance / noise;
    return value < -6.0 ? 0.0 : value > 6.0 ? 1.0 : normal_cdf(value);
  }

  static constexpr int kLongest = 100;  // an upper bound of counts for realistic thresholds

  std::span<const Step> steps_;
  std::span<double> result_;
  double on_ = 0.0, off_ = 0.0;
};

/// Computes the levels after black and after each active pattern; see sensor/pixel_model.h for the equations.
double follow_light(const capture::PixelConstants& constants, const PixelLight& light, std::span<Step> steps) {
  double inverse_level = 1.0 / light.inverse, level = std::log(light.inverse), black = 0.0;
  for (size_t n = 0; n < light.of_patterns.size(); ++n) {
    const double intensity = light.of_patterns[n], seconds = constants[n == 0 ? kBlackTime : kLitTime];
    const double target = 1.0 / intensity;
    inverse_level = target + (inverse_level - target) * std::exp(-constants[kReceptorRate] * seconds * intensity);
    const double receptor = -std::log(inverse_level);
    level = receptor + (level - receptor) * std::exp(-constants[kAmplifierRate] * seconds);
    if (n == 0) {
      black = level;
      continue;
    }
    const double fixed = constants[kNoise], shot = constants[kShotNoise];
    steps[n - 1] = {level, std::max(std::sqrt(fixed * fixed + shot * shot / intensity), kLeastNoise),
                    std::min(constants[kDarkOff] / intensity, 0.5), std::min(constants[kDarkOn] / intensity, 0.5)};
  }
  return black;
}

}  // namespace

size_t histogram_size(size_t transitions) {
  size_t size = 1;
  for (size_t n = 0; n < transitions; ++n) size *= kNumCounts;
  return size;
}

size_t count_place(int count) {
  return static_cast<size_t>(std::clamp(count, kLeastCount, kMostCount) - kLeastCount);
}

void count_distribution(const capture::PixelConstants& constants, const PixelLight& light, std::span<double> result) {
  static const std::array<Point, kPoints> points = make_points();
  const size_t transitions = light.of_patterns.size() - 1;
  E2LF_REQUIRE(transitions >= 1 && transitions <= kMostTransitions, "one to three lit patterns");
  E2LF_REQUIRE(result.size() == histogram_size(transitions), "the histogram fits the patterns");
  std::fill(result.begin(), result.end(), 0.0);
  std::array<Step, kMostTransitions> steps;
  const double black = follow_light(constants, light, steps);
  Paths paths(std::span<const Step>(steps).first(transitions), result);
  const double common = constants[kMismatch], own = constants[kMismatchEach], spread = std::hypot(common, own);
  const double shared = spread > 0.0 ? common * common / (spread * spread) : 0.0;
  for (const Point& point : points) {
    // Two correlated normal draws with the same standard deviation; ON and OFF share the common part.
    const double other = shared * point.both + std::sqrt(std::max(0.0, 1.0 - shared * shared)) * point.other;
    const double on = constants[kThresholdOn] * std::max(1.0 + spread * point.both, kLeastThreshold);
    const double off = constants[kThresholdOff] * std::max(1.0 + spread * other, kLeastThreshold);
    const double reference = black + off * constants[kResetSpan] * point.reset - constants[kResetOffset];
    paths.follow(on, off, reference, point.weight);
  }
}

}  // namespace e2lf::calibrate
