// SPDX-License-Identifier: MIT
#include "e2lf/depth/plane_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "e2lf/base/median.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"
#include "e2lf/lightfield/refocus.h"

namespace e2lf::depth {
namespace {

using lightfield::Image;
using lightfield::kShiftTaps;
using lightfield::LightField;
using lightfield::Shape;

constexpr float kMostStepPx = 0.25F;
/// A residual of this many standard deviations of the noise gets a weight of one quarter.
constexpr float kOutlier = 2.5F;
/// Light fields have at least the noise of 8-bit quantisation.
constexpr float kLeastNoise = 0.002F;

/// The Catmull-Rom taps at a position along one axis, and their derivatives.
struct Taps {
  ptrdiff_t first = 0;
  std::array<float, kShiftTaps> value{}, slope{};
};

Taps taps_at(float place) {
  const lightfield::ShiftFilter filter = lightfield::make_shift_filter(place);
  const float t = place - std::floor(place), t2 = t * t;
  return {
      filter.first,
      filter.taps,
      {0.5F * (-1 + 4 * t - 3 * t2), 0.5F * (-10 * t + 9 * t2), 0.5F * (1 + 8 * t - 9 * t2), 0.5F * (3 * t2 - 2 * t)}};
}

struct Sample {
  float value = 0, slope_y = 0, slope_x = 0;
};

Sample sample(const float* view, const Shape& shape, const Taps& at_y, const Taps& at_x) {
  const auto last_y = static_cast<ptrdiff_t>(shape.height) - 1, last_x = static_cast<ptrdiff_t>(shape.width) - 1;
  const bool is_inside = at_x.first >= 0 && at_x.first + kShiftTaps - 1 <= last_x;
  Sample result;
  for (int j = 0; j < kShiftTaps; ++j) {
    const float* row = view + std::clamp<ptrdiff_t>(at_y.first + j, 0, last_y) * (last_x + 1);
    std::array<float, kShiftTaps> pixels;
    for (int i = 0; i < kShiftTaps; ++i) {
      pixels[i] = row[is_inside ? at_x.first + i : std::clamp<ptrdiff_t>(at_x.first + i, 0, last_x)];
    }
    float value = 0, slope = 0;
    for (int i = 0; i < kShiftTaps; ++i) {
      value += at_x.value[i] * pixels[i];
      slope += at_x.slope[i] * pixels[i];
    }
    result.value += at_y.value[j] * value;
    result.slope_x += at_y.value[j] * slope;
    result.slope_y += at_y.slope[j] * value;
  }
  return result;
}

/// Returns the number of steps from the reference to a view along one axis.
float steps_to(size_t view, size_t reference) {
  return static_cast<float>(view) - static_cast<float>(reference);
}

class Measurer {
 public:
  Measurer(const LightField& light_field, const ViewIndex& reference, const Image& disparity)
      : light_field_(light_field),
        shape_(light_field.shape()),
        reference_(reference),
        disparity_(disparity),
        here_(light_field.view(reference.y, reference.x)) {}

  /// Uses a subset of pixels and views. Half of the residual is due to the noise of the reference.
  [[nodiscard]] float typical_residual() const {
    constexpr size_t kEveryPixel = 5, kEveryView = 3;
    std::vector<float> residuals;
    for (size_t y = kEveryPixel / 2; y < shape_.height; y += kEveryPixel) {
      for (size_t x = kEveryPixel / 2; x < shape_.width; x += kEveryPixel) {
        for (size_t view = (x + y) % kEveryView; view < shape_.num_views(); view += kEveryView) {
          const ViewIndex index{view / shape_.views_x, view % shape_.views_x};
          if (!(index == reference_)) residuals.push_back(std::abs(residual(y, x, index)));
        }
      }
    }
    if (residuals.empty()) return kLeastNoise;
    constexpr float kDeviationsPerMedian = 1.48F;
    return std::max(kDeviationsPerMedian * median(std::move(residuals)), kLeastNoise);
  }

  void measure_rows(size_t begin, size_t end, Measurements& out) const {
    std::vector<Taps> at_y(shape_.views_y), at_x(shape_.views_x);
    for (size_t y = begin; y < end && !stop_requested(); ++y) {
      for (size_t x = 0; x < shape_.width; ++x) {
        const size_t i = y * shape_.width + x;
        const float d = disparity_.pixels[i];
        for (size_t v = 0; v < at_y.size(); ++v) {
          at_y[v] = taps_at(static_cast<float>(y) + d * steps_to(v, reference_.y));
        }
        for (size_t v = 0; v < at_x.size(); ++v) {
          at_x[v] = taps_at(static_cast<float>(x) + d * steps_to(v, reference_.x));
        }
        const Sums sums = sum_views(y, x, at_y, at_x, out.noise);
        const float step = sums.slopes > 0 ? -sums.products / sums.slopes : 0;
        out.value.pixels[i] = d + std::clamp(step, -kMostStepPx, kMostStepPx);
        // Where few views agree with the reference, the noise is larger than elsewhere.
        out.weight.pixels[i] = sums.slopes * sums.weights / static_cast<float>(shape_.num_views() - 1);
      }
    }
  }

 private:
  struct Sums {
    float slopes = 0, products = 0, weights = 0;  ///< of w g^2, of w g r and of w
  };

  [[nodiscard]] float residual(size_t y, size_t x, const ViewIndex& view) const {
    const size_t i = y * shape_.width + x;
    const float d = disparity_.pixels[i];
    const Taps at_y = taps_at(static_cast<float>(y) + d * steps_to(view.y, reference_.y));
    const Taps at_x = taps_at(static_cast<float>(x) + d * steps_to(view.x, reference_.x));
    return sample(light_field_.view(view.y, view.x).data(), shape_, at_y, at_x).value - here_[i];
  }

  [[nodiscard]] Sums sum_views(size_t y, size_t x, const std::vector<Taps>& at_y, const std::vector<Taps>& at_x,
                               float noise) const {
    const size_t width = shape_.width, i = y * width + x;
    const size_t up = y == 0 ? i : i - width, down = y + 1 == shape_.height ? i : i + width;
    const size_t left = x == 0 ? i : i - 1, right = x + 1 == width ? i : i + 1;
    const float own_slope_y = 0.5F * (here_[down] - here_[up]), own_slope_x = 0.5F * (here_[right] - here_[left]);
    const float outlier = 1 / (kOutlier * kOutlier * noise * noise);
    Sums sums;
    for (size_t view_y = 0; view_y < shape_.views_y; ++view_y) {
      for (size_t view_x = 0; view_x < shape_.views_x; ++view_x) {
        if (view_y == reference_.y && view_x == reference_.x) continue;
        const Sample there = sample(light_field_.view(view_y, view_x).data(), shape_, at_y[view_y], at_x[view_x]);
        const float r = there.value - here_[i];
        // The slope of a view contains its own noise; the mean of both slopes avoids a bias.
        const float g = 0.5F * (steps_to(view_y, reference_.y) * (there.slope_y + own_slope_y) +
                                steps_to(view_x, reference_.x) * (there.slope_x + own_slope_x));
        const float ratio = 1 + r * r * outlier;
        const float w = 1 / (ratio * ratio);
        sums.slopes += w * g * g;
        sums.products += w * g * r;
        sums.weights += w;
      }
    }
    return sums;
  }

  const LightField& light_field_;
  const Shape& shape_;
  ViewIndex reference_;
  const Image& disparity_;
  std::span<const float> here_;
};

}  // namespace

float typical_residual(const LightField& light_field, const ViewIndex& reference, const Image& disparity) {
  return Measurer(light_field, reference, disparity).typical_residual();
}

Measurements measure(const LightField& light_field, const ViewIndex& reference, const Image& disparity) {
  const Shape& shape = light_field.shape();
  E2LF_REQUIRE(shape.channels == 1, "a grey light field");
  E2LF_REQUIRE(disparity.width == shape.width && disparity.height == shape.height, "a disparity for each pixel");
  const Measurer measurer(light_field, reference, disparity);
  Measurements out{Image(shape.width, shape.height, 1), Image(shape.width, shape.height, 1),
                   measurer.typical_residual()};
  parallel_for(shape.height, 4, [&](size_t begin, size_t end) { measurer.measure_rows(begin, end, out); });
  return out;
}

namespace {

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
