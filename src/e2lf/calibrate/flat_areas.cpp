// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/flat_areas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "e2lf/calibrate/count_distribution.h"

namespace e2lf::calibrate {
namespace {

constexpr double kLocalMeanPx = 7.0, kWindowPx = 10.0, kTexturePx = 1.5, kSlopePx = 6.0;
constexpr float kLeastVariance = 0.01F;  // of counts, so that a dark area without events is flat
constexpr size_t kMarginPx = 40;
constexpr double kLeastSamples = 150.0;
constexpr size_t kExamined = 3;  // transitions from which flat areas are found

/// The limits for texture and slope of a transition: the ratio of variances (1 for white noise), and the gradient
/// relative to its standard deviation for noise alone.
struct Limits {
  float texture, slope;
};
constexpr Limits kFirst{3.0F, 10.0F}, kSecond{2.0F, 5.0F}, kLater{1.4F, 3.5F};

Limits limits_of(size_t transition) {
  return transition == 0 ? kFirst : transition == 1 ? kSecond : kLater;
}

/// Computes the variance in a window around each pixel.
Plane local_variance(const Plane& plane) {
  return (blurred(plane.square(), kWindowPx) - blurred(plane, kWindowPx).square()).max(0.0F);
}

/// Returns the share of the variance of white noise that remains after blurring by kTexturePx, both without the local
/// mean.
float white_share() {
  constexpr Eigen::Index kSize = 129;
  Plane impulse = Plane::Zero(kSize, kSize);
  impulse(kSize / 2, kSize / 2) = 1.0F;
  const Plane residual = impulse - blurred(impulse, kLocalMeanPx);
  const auto energy = [](const Plane& plane) {
    double sum = 0.0;
    for (const float value : plane.reshaped<Eigen::RowMajor>()) sum += static_cast<double>(value) * value;
    return sum;
  };
  return static_cast<float>(energy(blurred(residual, kTexturePx)) / energy(residual));
}

/// Removes the pixels at which one transition has texture or slope.
void exclude_structure(const Plane& counts, const Plane& single_variance, const Limits& limits,
                       std::vector<bool>& is_flat) {
  static const float share_of_noise = white_share();
  const Plane residual = counts - blurred(counts, kLocalMeanPx);
  const Plane texture = local_variance(blurred(residual, kTexturePx));
  const Plane slope = squared_gradient(blurred(counts, kSlopePx));
  // The variance of one component of the gradient of white noise with variance 1.
  const auto slope_of_noise = static_cast<float>(1.0 / (8.0 * std::numbers::pi * std::pow(kSlopePx, 4.0)));
  for (size_t p = 0; p < is_flat.size(); ++p) {
    const float variance = single_variance.data()[p] + kLeastVariance;
    if (texture.data()[p] > limits.texture * share_of_noise * variance ||
        slope.data()[p] > limits.slope * limits.slope * slope_of_noise * variance) {
      is_flat[p] = false;
    }
  }
}

/// Computes the variance of the counts of single cycles around each pixel, which more cycles do not reduce.
Plane variance_of_cycles(const StillScene& scene, size_t transition, const std::vector<PixelState>& states) {
  Plane sum = Plane::Zero(static_cast<Eigen::Index>(scene.cycles.front().height),
                          static_cast<Eigen::Index>(scene.cycles.front().width));
  constexpr size_t kEnough = 4;
  const size_t taken = std::min(scene.cycles.size(), kEnough);
  for (size_t c = 0; c < taken; ++c) {
    StillScene single{{scene.cycles[c]}};
    const Plane counts = mean_counts(single, states)[transition];
    sum += local_variance(counts - blurred(counts, kLocalMeanPx)) / static_cast<float>(taken);
  }
  return sum;
}

size_t cell_of(const Plane& plane, size_t pixel) {
  const auto height = static_cast<size_t>(plane.rows()), width = static_cast<size_t>(plane.cols());
  const size_t y = pixel / width, x = pixel % width;
  return y * kFieldRows / height * kFieldColumns + x * kFieldColumns / width;
}

/// Returns all good pixels except those at the edges, with a brightness of 0.
FlatAreas good_areas(const Plane& like, const std::vector<PixelState>& states) {
  const auto height = static_cast<size_t>(like.rows()), width = static_cast<size_t>(like.cols());
  FlatAreas areas{std::vector<bool>(height * width), Plane::Zero(like.rows(), like.cols())};
  const size_t margin_y = std::min(kMarginPx, height / 8), margin_x = std::min(kMarginPx, width / 8);
  for (size_t y = margin_y; y < height - margin_y; ++y) {
    for (size_t x = margin_x; x < width - margin_x; ++x) {
      areas.is_flat[y * width + x] = states[y * width + x] == PixelState::kGood;
    }
  }
  return areas;
}

}  // namespace

FlatAreas find_flat_areas(const StillScene& scene, const std::vector<PixelState>& states) {
  const std::vector<Plane> counts = mean_counts(scene, states);
  FlatAreas areas = good_areas(counts.front(), states);
  for (size_t n = 0; n < std::min(counts.size(), kExamined); ++n) {
    exclude_structure(counts[n], variance_of_cycles(scene, n, states), limits_of(n), areas.is_flat);
    if (n < 2) areas.brightness += blurred(counts[n], kLocalMeanPx);
  }
  return areas;
}

FlatAreas even_areas(const StillScene& scene, const std::vector<PixelState>& states) {
  const std::vector<Plane> counts = mean_counts(scene, states);
  FlatAreas areas = good_areas(counts.front(), states);
  std::array<double, kFieldColumns*kFieldRows> sum = {}, pixels = {};
  for (size_t p = 0; p < areas.is_flat.size(); ++p) {
    if (!areas.is_flat[p]) continue;
    const size_t cell = cell_of(areas.brightness, p);
    pixels[cell] += 1.0;
    for (size_t n = 0; n < std::min<size_t>(counts.size(), 2); ++n) sum[cell] += counts[n].data()[p];
  }
  for (size_t p = 0; p < areas.is_flat.size(); ++p) {
    const size_t cell = cell_of(areas.brightness, p);
    areas.brightness.data()[p] = static_cast<float>(sum[cell] / std::max(pixels[cell], 1.0));
  }
  return areas;
}

std::vector<Area> collect_areas(const StillScene& scene, size_t scene_number, const FlatAreas& flat,
                                const SquareFilter& is_counted) {
  const capture::EventImages& first = scene.cycles.front();
  const std::vector<CountGroup> groups = count_groups(first.count);
  std::map<std::pair<size_t, size_t>, Area> areas;  // by row and cell
  for (size_t p = 0; p < flat.is_flat.size(); ++p) {
    const size_t y = p / first.width, x = p % first.width;
    if (!flat.is_flat[p] || !is_counted(y / kSquarePx, x / kSquarePx)) continue;
    const auto row = static_cast<size_t>(std::max((flat.brightness.data()[p] - kFirstRow) / kRowWidth, 0.0F));
    const size_t cell = cell_of(flat.brightness, p);
    Area& area = areas[{row, cell}];
    if (area.histogram.empty()) {
      area.row = row;
      area.cell = cell;
      area.scene = scene_number;
      area.transitions = first.count;
      area.histogram.resize(histogram_size(first.count));
    }
    const float half_width = 0.5F * static_cast<float>(first.width);
    for (const capture::EventImages& cycle : scene.cycles) {
      for (const CountGroup& group : groups) {
        area.histogram[group.cell_of([&](size_t n) { return cycle.image(n)[p]; })] += 1.0F;
      }
      area.samples += 1.0;
      area.x += (static_cast<float>(x) + 0.5F) / half_width - 1.0F;
      area.y += (static_cast<float>(y) + 0.5F - 0.5F * static_cast<float>(first.height)) / half_width;
    }
  }
  std::vector<Area> result;
  for (auto& [key, area] : areas) {
    if (area.samples < kLeastSamples) continue;
    for (float& share : area.histogram) share /= static_cast<float>(area.samples);
    area.x /= area.samples;
    area.y /= area.samples;
    result.push_back(std::move(area));
  }
  return result;
}

}  // namespace e2lf::calibrate
