// SPDX-License-Identifier: MIT
#include "e2lf/depth/plane_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"

namespace e2lf::depth {
namespace {

using lightfield::Image;

/// The regularisation of slopes towards their previous values, as px^2 of the spread of the samples.
constexpr float kSlopePullPx2 = 0.3F, kPriorSlopePullPx2 = 20.0F;
/// The weight of a measurement without texture relative to the noise variance. Its disparity, which comes from its
/// surroundings, is used if there is nothing else.
constexpr float kLeastWeight = 0.05F;

/// Weighted sums over a window for each pixel of a row, with offsets dy, dx and v = disparity - present value.
struct RowSums {
  explicit RowSums(size_t width) {
    for (auto* sum : all()) sum->resize(width);
  }
  std::array<std::vector<float>*, 10> all() {
    return {&one, &dy, &dx, &dy_dy, &dx_dy, &dx_dx, &v, &v_dy, &v_dx, &offered};
  }
  void clear() {
    for (auto* sum : all()) std::fill(sum->begin(), sum->end(), 0.0F);
  }
  std::vector<float> one, dy, dx, dy_dy, dx_dy, dx_dx, v, v_dy, v_dx;
  std::vector<float> offered;  ///< of the weights before the comparison with the plane
};

class Fitter {
 public:
  Fitter(const Measurements& measurements, const Image& picture, const PlaneFit& options, const Planes& before)
      : measurements_(measurements), picture_(picture), options_(options), before_(before), width_(before.value.width) {
    least_weight_ = kLeastWeight * measurements.noise * measurements.noise;
    if (options.prior_error > 0) {
      const float ratio = measurements.noise / options.prior_error;
      prior_weight_ = ratio * ratio;
    }
  }

  void fit_row(size_t y, RowSums& sums, Planes& out) const {
    sums.clear();
    const auto height = static_cast<ptrdiff_t>(before_.value.height);
    for (int j = -options_.radius; j <= options_.radius; ++j) {
      const ptrdiff_t from_y = static_cast<ptrdiff_t>(y) + j * options_.spacing;
      if (from_y < 0 || from_y >= height) continue;
      for (int i = -options_.radius; i <= options_.radius; ++i) {
        const auto rim = static_cast<float>(options_.radius + 1);
        const float nearness = 1 - static_cast<float>(i * i + j * j) / (rim * rim);
        if (nearness > 0) add_samples(y, j * options_.spacing, i * options_.spacing, nearness, sums);
      }
    }
    for (size_t x = 0; x < width_; ++x) solve(y, x, sums, out);
  }

 private:
  /// Adds to each pixel of row y its neighbour at (dy, dx).
  void add_samples(size_t y, int dy, int dx, float nearness, RowSums& sums) const {
    const auto begin = static_cast<size_t>(std::max(0, -dx));
    const auto margin = static_cast<size_t>(std::max(0, dx));
    if (margin >= width_) return;
    const size_t end = width_ - margin;
    const auto here = static_cast<ptrdiff_t>(y * width_);
    const ptrdiff_t there = here + dy * static_cast<ptrdiff_t>(width_) + dx;
    const float *value = measurements_.value.pixels.data() + there,
                *weight = measurements_.weight.pixels.data() + there;
    const float* present = before_.value.pixels.data() + here;
    const float *slope_y = before_.slope_y.pixels.data() + here, *slope_x = before_.slope_x.pixels.data() + here;
    const float *own_grey = picture_.pixels.data() + here, *grey = picture_.pixels.data() + there;
    const auto step_y = static_cast<float>(dy), step_x = static_cast<float>(dx);
    const float unlike = 1 / options_.contrast;
    const float off_plane = 1 / (options_.tolerance * options_.tolerance);
    for (size_t x = begin; x < end; ++x) {
      const float v = value[x] - present[x];
      const float distance = v - step_y * slope_y[x] - step_x * slope_x[x];
      const float ratio = 1 + distance * distance * off_plane;
      const float difference = unlike * (grey[x] - own_grey[x]);
      const float likeness = 1 / (1 + difference * difference);
      const float offered = (weight[x] + least_weight_) * nearness * likeness * likeness;
      const float w = offered / (ratio * ratio);
      sums.offered[x] += offered;
      sums.one[x] += w;
      sums.dy[x] += w * step_y;
      sums.dx[x] += w * step_x;
      sums.dy_dy[x] += w * step_y * step_y;
      sums.dx_dy[x] += w * step_x * step_y;
      sums.dx_dx[x] += w * step_x * step_x;
      sums.v[x] += w * v;
      sums.v_dy[x] += w * v * step_y;
      sums.v_dx[x] += w * v * step_x;
    }
  }

  void solve(size_t y, size_t x, const RowSums& sums, Planes& out) const {
    const size_t i = y * width_ + x;
    const float total = sums.one[x] + prior_weight_;
    const float mean_y = sums.dy[x] / total, mean_x = sums.dx[x] / total, mean_v = sums.v[x] / total;
    const float pull = kSlopePullPx2 * sums.one[x] + kPriorSlopePullPx2 * prior_weight_;
    const float old_y = prior_weight_ > 0 ? before_.slope_y.pixels[i] : 0;
    const float old_x = prior_weight_ > 0 ? before_.slope_x.pixels[i] : 0;
    const float yy = sums.dy_dy[x] - mean_y * sums.dy[x] + pull, xx = sums.dx_dx[x] - mean_x * sums.dx[x] + pull;
    const float xy = sums.dx_dy[x] - mean_x * sums.dy[x];
    const float vy = sums.v_dy[x] - mean_v * sums.dy[x] + pull * old_y;
    const float vx = sums.v_dx[x] - mean_v * sums.dx[x] + pull * old_x;
    const float determinant = yy * xx - xy * xy;
    const bool is_solvable = determinant > 0;
    const float slope_y = is_solvable ? (vy * xx - vx * xy) / determinant : 0;
    const float slope_x = is_solvable ? (vx * yy - vy * xy) / determinant : 0;
    out.slope_y.pixels[i] = slope_y;
    out.slope_x.pixels[i] = slope_x;
    out.value.pixels[i] = before_.value.pixels[i] + mean_v - slope_y * mean_y - slope_x * mean_x;
    out.weight.pixels[i] = sums.one[x];
    out.agreement.pixels[i] = sums.one[x] / sums.offered[x];
  }

  const Measurements& measurements_;
  const Image& picture_;
  const PlaneFit& options_;
  const Planes& before_;
  size_t width_;
  float least_weight_ = 0, prior_weight_ = 0;
};

}  // namespace

Planes flat_planes(const Image& disparity) {
  const Image nothing(disparity.width, disparity.height, 1);
  return {disparity, nothing, nothing, nothing, nothing};
}

void fit_planes(const Measurements& measurements, const Image& picture, const PlaneFit& options, Planes& planes) {
  E2LF_REQUIRE(measurements.value.width == planes.value.width && measurements.value.height == planes.value.height,
               "a measurement for each pixel");
  E2LF_REQUIRE(picture.width == planes.value.width && picture.pixels.size() == planes.value.pixels.size(),
               "the picture is the grey view");
  E2LF_REQUIRE(options.radius > 0 && options.spacing > 0 && options.tolerance > 0, "a window needs a size");
  const Planes before = planes;
  const Fitter fitter(measurements, picture, options, before);
  parallel_for(before.value.height, 4, [&](size_t begin, size_t end) {
    RowSums sums(before.value.width);
    for (size_t y = begin; y < end && !stop_requested(); ++y) fitter.fit_row(y, sums, planes);
  });
}

}  // namespace e2lf::depth
