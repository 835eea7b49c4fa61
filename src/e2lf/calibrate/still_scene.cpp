// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/still_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <utility>

#include "e2lf/base/median.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/calibrate/count_distribution.h"
#include "e2lf/capture/measurement/hot_pixels.h"

namespace e2lf::calibrate {
namespace {

std::vector<float> gaussian_kernel(double sigma_px) {
  const auto radius = static_cast<size_t>(std::ceil(4.0 * sigma_px));
  std::vector<float> kernel(2 * radius + 1);
  double sum = 0.0;
  for (size_t i = 0; i < kernel.size(); ++i) {
    const double distance = (static_cast<double>(i) - static_cast<double>(radius)) / sigma_px;
    kernel[i] = static_cast<float>(std::exp(-0.5 * distance * distance));
    sum += kernel[i];
  }
  for (float& weight : kernel) weight /= static_cast<float>(sum);
  return kernel;
}

/// Returns the mirrored position of a pixel beyond the edges; the edge is repeated, so that -1 becomes 0.
size_t mirrored(ptrdiff_t place, size_t size) {
  const auto period = static_cast<ptrdiff_t>(2 * size);
  ptrdiff_t inside = place % period;
  if (inside < 0) inside += period;
  return static_cast<size_t>(inside < static_cast<ptrdiff_t>(size) ? inside : period - 1 - inside);
}

/// Blurs every row and transposes the plane, so that two calls blur in both directions.
Plane blur_rows_transposed(const Plane& plane, const std::vector<float>& kernel) {
  Plane result(plane.cols(), plane.rows());
  const auto height = static_cast<size_t>(plane.rows()), width = static_cast<size_t>(plane.cols());
  const auto radius = static_cast<ptrdiff_t>(kernel.size() / 2);
  parallel_for(height, 16, [&](size_t begin, size_t end) {
    std::vector<float> row(width + kernel.size());
    for (size_t y = begin; y < end; ++y) {
      const float* source = plane.data() + y * width;
      for (size_t i = 0; i < row.size(); ++i) row[i] = source[mirrored(static_cast<ptrdiff_t>(i) - radius, width)];
      for (size_t x = 0; x < width; ++x) {
        float sum = 0.0F;
        for (size_t i = 0; i < kernel.size(); ++i) sum += kernel[i] * row[x + i];
        result.data()[x * height + y] = sum;
      }
    }
  });
  return result;
}

}  // namespace

Plane blurred(const Plane& plane, double sigma_px) {
  const std::vector<float> kernel = gaussian_kernel(sigma_px);
  return blur_rows_transposed(blur_rows_transposed(plane, kernel), kernel);
}

Plane squared_gradient(const Plane& plane) {
  Plane result = Plane::Zero(plane.rows(), plane.cols());
  const Eigen::Index height = plane.rows() - 2, width = plane.cols() - 2;
  const auto from = [&](Eigen::Index y, Eigen::Index x) { return plane.block(y, x, height, width); };
  result.block(1, 1, height, width) =
      (0.5F * (from(1, 2) - from(1, 0))).square() + (0.5F * (from(2, 1) - from(0, 1))).square();
  return result;
}

namespace {

constexpr size_t kLeastSize = 64;
constexpr size_t kMostNeighbours = 24;

/// The signed counts of each transition summed over the cycles of a scene, and the total number of events.
struct SceneSums {
  capture::CountSums signed_counts;
  std::vector<int32_t> activity;

  [[nodiscard]] size_t height() const { return signed_counts.counts.height; }
  [[nodiscard]] size_t width() const { return signed_counts.counts.width; }
};

SceneSums sums_of(const StillScene& scene) {
  SceneSums sums{{}, std::vector<int32_t>(scene.cycles.front().image_size())};
  for (const capture::EventImages& cycle : scene.cycles) {
    sums.signed_counts.add(cycle);
    for (size_t n = 0; n < cycle.count; ++n) {
      const auto image = cycle.image(n);
      for (size_t p = 0; p < image.size(); ++p) sums.activity[p] += std::abs(image[p]);
    }
  }
  return sums;
}

/// Returns true if all neighbours of a pixel have enough events for its silence to be significant.
bool is_lit(const SceneSums& sums, size_t pixel) {
  constexpr size_t kOutliers = 2;  // neighbours that may be dead, too
  std::array<int32_t, kMostNeighbours> activity{};
  size_t count = 0;
  capture::each_neighbour(sums.height(), sums.width(), pixel,
                          [&](size_t neighbour) { activity[count++] = sums.activity[neighbour]; });
  std::sort(activity.begin(), activity.begin() + static_cast<ptrdiff_t>(count));
  const auto cycles = static_cast<int32_t>(sums.signed_counts.cycles);
  return activity[kOutliers] >= cycles && activity[count / 2] >= 2 * cycles;
}

}  // namespace

std::vector<PixelState> find_bad_pixels(const std::vector<StillScene>& scenes) {
  std::vector<SceneSums> sums;
  for (const StillScene& scene : scenes) sums.push_back(sums_of(scene));
  std::vector<PixelState> states(sums.front().activity.size(), PixelState::kGood);
  parallel_for(states.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const bool is_silent =
          std::all_of(sums.begin(), sums.end(), [&](const SceneSums& each) { return each.activity[p] == 0; });
      if (is_silent && std::any_of(sums.begin(), sums.end(), [&](const SceneSums& each) { return is_lit(each, p); })) {
        states[p] = PixelState::kDead;
      }
    }
  });
  std::vector<size_t> hot_in(states.size());
  // Still scenes allow lower limits than recordings do.
  constexpr capture::HotLimits kLimits{.beyond_range = 0.75F, .in_single_cycle = 2};
  for (const SceneSums& each : sums) {
    for (const size_t p : capture::hot_pixels(each.signed_counts, kLimits)) {
      if (++hot_in[p] == sums.size()) states[p] = PixelState::kHot;
    }
  }
  return states;
}

Result<void> check_scenes(const std::vector<StillScene>& scenes) {
  if (scenes.empty() || scenes.front().cycles.empty()) {
    return fail(ErrorCode::kShape, "", "the calibration needs at least one cycle; give event images or a recording");
  }
  const capture::EventImages& first = scenes.front().cycles.front();
  if (first.count < 1) {
    return fail(ErrorCode::kShape, "", "the cycles have no transitions; calibrate with at least two patterns");
  }
  if (first.height < kLeastSize || first.width < kLeastSize) {
    return fail(ErrorCode::kShape, "", "pictures of ", first.width, "x", first.height,
                " px are too small; give at least ", kLeastSize, "x", kLeastSize);
  }
  for (const StillScene& scene : scenes) {
    for (const capture::EventImages& cycle : scene.cycles) {
      if (cycle.count == first.count && cycle.height == first.height && cycle.width == first.width) continue;
      return fail(ErrorCode::kShape, "",
                  "the cycles differ in size or in their number of transitions; give scenes of one camera with the "
                  "same patterns");
    }
    if (scene.cycles.empty()) return fail(ErrorCode::kShape, "", "a scene contains no cycle; leave it out");
  }
  return {};
}

std::vector<Plane> mean_counts(const StillScene& scene, const std::vector<PixelState>& states) {
  capture::CountSums sums;
  for (const capture::EventImages& cycle : scene.cycles) sums.add(cycle);
  const size_t height = sums.counts.height, width = sums.counts.width;
  std::vector<Plane> planes;
  for (size_t n = 0; n < sums.counts.count; ++n) {
    const auto counts = sums.counts.image(n);
    Plane& plane = planes.emplace_back(height, width);
    const auto mean = [&](size_t p) { return static_cast<float>(counts[p]) / static_cast<float>(sums.cycles); };
    for (size_t p = 0; p < counts.size(); ++p) {
      plane.data()[p] = mean(p);
      if (states[p] == PixelState::kGood) continue;
      std::vector<float> around;
      capture::each_neighbour(height, width, p, [&](size_t neighbour) {
        if (states[neighbour] == PixelState::kGood) around.push_back(mean(neighbour));
      });
      if (around.empty()) continue;
      plane.data()[p] = median(std::move(around));
    }
  }
  return planes;
}

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
