// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/still_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "e2lf/base/median.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"

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
constexpr size_t kReachPx = 2;  // the largest distance of neighbours, in px
constexpr size_t kMostNeighbours = (2 * kReachPx + 1) * (2 * kReachPx + 1) - 1;

/// The signed counts of each transition summed over the cycles of a scene, and the total number of events.
struct NeighbourSums {
  size_t height = 0, width = 0, cycles = 0;
  std::vector<std::vector<int32_t>> counts;
  std::vector<int32_t> activity;
};

NeighbourSums sums_of(const StillScene& scene) {
  const capture::EventImages& first = scene.cycles.front();
  NeighbourSums sums{first.height, first.width, scene.cycles.size(), {}, std::vector<int32_t>(first.image_size())};
  sums.counts.assign(first.count, std::vector<int32_t>(first.image_size()));
  for (const capture::EventImages& cycle : scene.cycles) {
    for (size_t n = 0; n < cycle.count; ++n) {
      const auto image = cycle.image(n);
      for (size_t p = 0; p < image.size(); ++p) {
        sums.counts[n][p] += image[p];
        sums.activity[p] += std::abs(image[p]);
      }
    }
  }
  return sums;
}

/// Calls visit(neighbour) for the neighbours of a pixel that lie in the picture.
template <typename Visit>
void each_neighbour(size_t height, size_t width, size_t pixel, const Visit& visit) {
  const size_t y = pixel / width, x = pixel % width;
  for (size_t v = y - std::min(y, kReachPx); v <= std::min(y + kReachPx, height - 1); ++v) {
    for (size_t u = x - std::min(x, kReachPx); u <= std::min(x + kReachPx, width - 1); ++u) {
      if (v != y || u != x) visit(v * width + u);
    }
  }
}

/// Returns by how many events a pixel leaves the range of its neighbours widened to twice its size, over all
/// transitions. Over many cycles, pixels with unusual thresholds leave the range itself; excluding them would bias the
/// mismatch.
int32_t excess(const NeighbourSums& sums, size_t pixel) {
  int32_t sum = 0;
  for (const auto& counts : sums.counts) {
    int32_t least = INT32_MAX, most = INT32_MIN;
    each_neighbour(sums.height, sums.width, pixel, [&](size_t neighbour) {
      least = std::min(least, counts[neighbour]);
      most = std::max(most, counts[neighbour]);
    });
    const int32_t slack = (most - least) / 2;
    sum += std::max({0, counts[pixel] - most - slack, least - slack - counts[pixel]});
  }
  return sum;
}

bool is_hot(const NeighbourSums& sums, size_t pixel) {
  const auto cycles = static_cast<double>(sums.cycles);
  return excess(sums, pixel) >= std::max(3.0 * std::sqrt(cycles), cycles);
}

/// Returns true if all neighbours of a pixel have enough events for its silence to be significant.
bool is_lit(const NeighbourSums& sums, size_t pixel) {
  constexpr size_t kOutliers = 2;  // neighbours that may be dead, too
  std::array<int32_t, kMostNeighbours> activity{};
  size_t count = 0;
  each_neighbour(sums.height, sums.width, pixel,
                 [&](size_t neighbour) { activity[count++] = sums.activity[neighbour]; });
  std::sort(activity.begin(), activity.begin() + static_cast<ptrdiff_t>(count));
  const auto cycles = static_cast<int32_t>(sums.cycles);
  return activity[kOutliers] >= cycles && activity[count / 2] >= 2 * cycles;
}

}  // namespace

std::vector<PixelState> find_bad_pixels(const std::vector<StillScene>& scenes) {
  std::vector<NeighbourSums> sums;
  for (const StillScene& scene : scenes) sums.push_back(sums_of(scene));
  std::vector<PixelState> states(sums.front().activity.size(), PixelState::kGood);
  parallel_for(states.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const auto in_all = [&](const auto& test) { return std::all_of(sums.begin(), sums.end(), test); };
      // Dead pixels are tested first, because they also leave the range of bright neighbours.
      if (in_all([&](const NeighbourSums& each) { return each.activity[p] == 0; }) &&
          std::any_of(sums.begin(), sums.end(), [&](const NeighbourSums& each) { return is_lit(each, p); })) {
        states[p] = PixelState::kDead;
      } else if (in_all([&](const NeighbourSums& each) { return each.activity[p] > 0 && is_hot(each, p); })) {
        states[p] = PixelState::kHot;
      }
    }
  });
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
  const NeighbourSums sums = sums_of(scene);
  std::vector<Plane> planes;
  for (const auto& counts : sums.counts) {
    Plane& plane = planes.emplace_back(sums.height, sums.width);
    const auto mean = [&](size_t p) { return static_cast<float>(counts[p]) / static_cast<float>(sums.cycles); };
    for (size_t p = 0; p < counts.size(); ++p) {
      plane.data()[p] = mean(p);
      if (states[p] == PixelState::kGood) continue;
      std::vector<float> around;
      each_neighbour(sums.height, sums.width, p, [&](size_t neighbour) {
        if (states[neighbour] == PixelState::kGood) around.push_back(mean(neighbour));
      });
      if (around.empty()) continue;
      plane.data()[p] = median(std::move(around));
    }
  }
  return planes;
}

}  // namespace e2lf::calibrate
