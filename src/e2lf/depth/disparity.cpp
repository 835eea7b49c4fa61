// SPDX-License-Identifier: MIT
#include "e2lf/depth/disparity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/depth/plane_fit.h"
#include "e2lf/depth/view_order.h"
#include "e2lf/lightfield/views.h"

namespace e2lf::depth {
namespace {

using lightfield::Image;
using lightfield::LightField;
using lightfield::Shape;

/// The shift between neighbouring labels in the farthest view.
constexpr float kLabelSpacingPx = 0.5F;
constexpr size_t kMostLabels = 256;
/// The least mean confidence of true views with texture.
constexpr double kUsualConfidence = 0.45;
constexpr uint64_t kMostBytes = uint64_t{8} << 30;

/// The radius of the window of similar pixels.
constexpr ptrdiff_t kRadius = 4;
constexpr size_t kTaps = 2 * kRadius + 1;
constexpr float kSigmaPx = 2.0F;
/// The difference in brightness that reduces the weight of a neighbour to a quarter.
constexpr float kUnlike = 0.04F;
/// What remains of the mean keeps the strong edges of untextured objects.
constexpr float kShare = 0.7F;

using Lines = std::array<const float*, kTaps>;

std::array<float, kTaps> gaussian() {
  std::array<float, kTaps> taps{};
  for (size_t k = 0; k < kTaps; ++k) {
    const auto offset = static_cast<float>(static_cast<ptrdiff_t>(k) - kRadius) / kSigmaPx;
    taps[k] = std::exp(-0.5F * offset * offset);
  }
  return taps;
}

/// Computes the weighted mean of each pixel of the middle line and of those beside it in the other lines.
void mean_of_similar(const Lines& lines, size_t count, float* mean) {
  static const std::array<float, kTaps> taps = gaussian();
  const float* const middle = lines[kRadius];
  for (size_t x = 0; x < count; ++x) {
    float sum = 0, total = 0;
    for (size_t k = 0; k < kTaps; ++k) {
      const float ratio = (lines[k][x] - middle[x]) * (1 / kUnlike);
      const float unlike = 1 + ratio * ratio;
      const float weight = taps[k] / (unlike * unlike);
      sum += weight * lines[k][x];
      total += weight;
    }
    mean[x] = sum / total;
  }
}

void mean_along_rows(const float* view, size_t height, size_t width, float* mean) {
  std::vector<float> padded(width + 2 * kRadius);
  Lines lines;
  for (size_t k = 0; k < kTaps; ++k) lines[k] = padded.data() + k;
  for (size_t y = 0; y < height; ++y) {
    const float* const row = view + y * width;
    std::fill_n(padded.begin(), kRadius, row[0]);
    std::copy_n(row, width, padded.begin() + kRadius);
    std::fill_n(padded.end() - kRadius, kRadius, row[width - 1]);
    mean_of_similar(lines, width, mean + y * width);
  }
}

/// Subtracts from a view the means of its rows, averaged along columns.
void subtract_mean(const std::vector<float>& row_means, size_t height, size_t width, float* view) {
  std::vector<float> mean(width);
  Lines lines;
  for (size_t y = 0; y < height; ++y) {
    for (size_t k = 0; k < kTaps; ++k) {
      const ptrdiff_t row = static_cast<ptrdiff_t>(y + k) - kRadius;
      lines[k] = row_means.data() +
                 std::clamp<ptrdiff_t>(row, 0, static_cast<ptrdiff_t>(height) - 1) * static_cast<ptrdiff_t>(width);
    }
    mean_of_similar(lines, width, mean.data());
    for (size_t x = 0; x < width; ++x) view[y * width + x] -= kShare * mean[x];
  }
}

/// Returns a grey light field without most of its shading: from each pixel it subtracts 70 % of the mean of similar
/// pixels around it in the same view, a separable bilateral mean within 4 px. Shading and reflections that do not move
/// with the surface would otherwise outweigh weak texture, and the mean over dissimilar pixels would extend edges.
LightField detail_of(const LightField& light_field) {
  const Shape& shape = light_field.shape();
  LightField detail = light_field;
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    std::vector<float> row_means(shape.height * shape.width);
    for (size_t view = begin; view < end && !stop_requested(); ++view) {
      const auto values = detail.view(view / shape.views_x, view % shape.views_x);
      mean_along_rows(values.data(), shape.height, shape.width, row_means.data());
      subtract_mean(row_means, shape.height, shape.width, values.data());
    }
  });
  return detail;
}

/// Shrinks every view by a whole factor. The remainder at the right and bottom is cut off.
LightField shrunk(const LightField& light_field, size_t factor) {
  Shape shape = light_field.shape();
  shape.height /= factor;
  shape.width /= factor;
  LightField small(shape);
  const float scale = 1 / static_cast<float>(factor * factor);
  for (size_t view_y = 0; view_y < shape.views_y; ++view_y) {
    for (size_t view_x = 0; view_x < shape.views_x; ++view_x) {
      for (size_t y = 0; y < shape.height * factor; ++y) {
        for (size_t x = 0; x < shape.width * factor; ++x) {
          small.at(view_y, view_x, y / factor, x / factor) += scale * light_field.at(view_y, view_x, y, x);
        }
      }
    }
  }
  return small;
}

size_t farthest_steps(const Shape& shape, const ViewIndex& view) {
  return std::max({view.y, shape.views_y - 1 - view.y, view.x, shape.views_x - 1 - view.x});
}

Labels labels_for(const DisparityRange& range, size_t steps) {
  Labels labels;
  const float width = range.most - range.least;
  const float spacing = kLabelSpacingPx / static_cast<float>(steps);
  labels.first = range.least;
  labels.count = static_cast<size_t>(std::min(std::ceil(width / spacing), static_cast<float>(kMostLabels - 1))) + 1;
  labels.count = std::max<size_t>(labels.count, 2);
  labels.step = width / static_cast<float>(labels.count - 1);
  return labels;
}

/// Returns the label with the lowest cost at each pixel, refined by the parabola through it and its neighbours.
Image best_disparities(const CostVolume& volume) {
  Image disparity(volume.width, volume.height, 1);
  const auto last = static_cast<ptrdiff_t>(volume.labels.count) - 1;
  for (size_t i = 0; i < disparity.pixels.size(); ++i) {
    const int16_t* const costs = volume.costs.data() + i * volume.labels.count;
    const ptrdiff_t best = std::min_element(costs, costs + last + 1) - costs;
    auto label = static_cast<float>(best);
    if (best > 0 && best < last) {
      const int before = costs[best - 1] - costs[best], after = costs[best + 1] - costs[best];
      if (before + after > 0) label += 0.5F * static_cast<float>(before - after) / static_cast<float>(before + after);
    }
    disparity.pixels[i] = volume.labels.disparity(label);
  }
  return disparity;
}

/// Returns the grey value difference beyond which its magnitude does not matter. It grows with the contrast.
float most_difference(const Image& picture) {
  constexpr float kDeviations = 0.8F, kLeast = 0.02F, kMost = 0.2F;
  double sum = 0, squares = 0;
  for (float value : picture.pixels) {
    sum += value;
    squares += double{value} * double{value};
  }
  const auto count = static_cast<double>(picture.pixels.size());
  const double variance = std::max(squares / count - sum * sum / (count * count), 0.0);
  return std::clamp(kDeviations * static_cast<float>(std::sqrt(variance)), kLeast, kMost);
}

/// Finds disparities in the detail of the views; `picture` is the view itself.
Image coarse_disparities(const LightField& detail, const Image& picture, const ViewIndex& view,
                         const DisparityRange& range, const ProgressFn& progress) {
  const Labels labels = labels_for(range, farthest_steps(detail.shape(), view));
  const float most = most_difference(lightfield::view_image(detail, view.y, view.x));
  CostVolume volume = matching_costs(detail, view, labels, most, progress);
  smooth_costs(volume, picture);
  return best_disparities(volume);
}

/// Derives the confidence from the error that the texture implies. It is lower where neighbours disagree.
Image confidence_of(const Planes& planes, float noise) {
  constexpr float kHalfPx = 0.07F;
  // The measurements of neighbours are not independent: they share the noise of the reference, the blur and the model.
  constexpr float kCommonErrors = 6.0F;
  Image confidence(planes.value.width, planes.value.height, 1);
  for (size_t i = 0; i < confidence.pixels.size(); ++i) {
    const float error = kCommonErrors * noise / std::sqrt(std::max(planes.weight.pixels[i], 1e-12F));
    const float ratio = error / kHalfPx;
    confidence.pixels[i] = planes.agreement.pixels[i] / (1 + ratio * ratio);
  }
  return confidence;
}

/// Fails if a stop was requested. Each stage then skips its remaining work.
Result<void> check_stop() {
  if (!stop_requested()) return {};
  return fail(ErrorCode::kCancelled, "", "the disparities were not found to the end; run it again");
}

/// Estimates the map of a grey light field by comparing its views in `detail`.
Result<DisparityMap> map_within(const LightField& light_field, const LightField& detail, const ViewIndex& view,
                                const DisparityRange& range, const ProgressFn& progress) {
  DisparityMap map{{}, {}, view, range, 0};
  const Image picture = lightfield::view_image(light_field, view.y, view.x);
  Planes planes = flat_planes(coarse_disparities(detail, picture, view, range, progress));
  E2LF_RETURN_IF_ERROR(check_stop());
  constexpr PlaneFit kPasses[] = {{.spacing = 3, .tolerance = 0.1F}, {.spacing = 3, .tolerance = 0.07F}};
  float noise = 0;
  for (PlaneFit pass : kPasses) {
    const Measurements measurements = measure(detail, view, planes.value);
    noise = measurements.noise;
    fit_planes(measurements, picture, pass, planes);
    pass.spacing = 1;
    pass.prior_error = 0.01F;
    fit_planes(measurements, picture, pass, planes);
    E2LF_RETURN_IF_ERROR(check_stop());
  }
  map.confidence = confidence_of(planes, noise);
  map.residual = typical_residual(light_field, view, planes.value);
  map.disparity = std::move(planes.value);
  return map;
}

/// Returns the disparities of the pixels with a higher confidence than this, sorted.
std::vector<float> sure_disparities(const DisparityMap& map, float least_confidence) {
  std::vector<float> sure;
  for (size_t i = 0; i < map.disparity.pixels.size(); ++i) {
    if (map.confidence.pixels[i] > least_confidence) sure.push_back(map.disparity.pixels[i]);
  }
  std::sort(sure.begin(), sure.end());
  return sure;
}

/// Finds the range of the disparities of confident pixels on shrunk views, without a thousandth at either end, and adds
/// a margin. In dark areas of low contrast, any disparity fits; they are ignored as long as there are other pixels.
Result<DisparityRange> find_range(const LightField& light_field, const ViewIndex& view) {
  constexpr size_t kEnoughPixels = 192;
  constexpr float kSure = 0.7F;
  const Shape& shape = light_field.shape();
  const size_t factor = std::clamp<size_t>(std::min(shape.height, shape.width) / kEnoughPixels, 1, 8);
  const float scale = static_cast<float>(factor), farthest = kFarthestPx / scale;
  const LightField small = factor == 1 ? light_field : shrunk(light_field, factor);
  E2LF_ASSIGN_OR_RETURN(const DisparityMap map, map_within(small, detail_of(small), view, {-farthest, farthest}, {}));
  std::vector<float> sorted = sure_disparities(map, kSure);
  if (sorted.size() <= map.disparity.pixels.size() / 50) sorted = sure_disparities(map, -1);
  const size_t last = sorted.size() - 1, few = last / 1000;
  const float margin = 0.1F + kLabelSpacingPx / static_cast<float>(farthest_steps(shape, view));
  return DisparityRange{scale * sorted[few] - margin, scale * sorted[last - few] + margin};
}

Result<void> check(const LightField& light_field, const ViewIndex& view, const DisparityOptions& options) {
  constexpr float kLargest = 1e6F;  // the squares of larger values overflow
  const Shape& shape = light_field.shape();
  if (shape.num_views() < 2 || shape.height == 0 || shape.width == 0) {
    return fail(ErrorCode::kShape, "", "a single view contains no disparity; give a light field of several views");
  }
  if (view.y >= shape.views_y || view.x >= shape.views_x) {
    return fail(ErrorCode::kNotFound, "", "there is no view (", view.y, ", ", view.x, ") in ", shape.views_y, "x",
                shape.views_x, " views; count from 0");
  }
  if (options.range && !(std::isfinite(options.range->least) && std::isfinite(options.range->most) &&
                         options.range->least < options.range->most)) {
    return fail(ErrorCode::kInvalidValue, "", "the range of disparities is empty; give the smaller one first");
  }
  // This limit allows for three arrays of costs with the largest number of labels.
  const uint64_t bytes_per_pixel = 3 * kMostLabels * sizeof(int16_t);
  if (uint64_t{shape.height} > kMostBytes / bytes_per_pixel / shape.width) {
    return fail(ErrorCode::kUnsupported, "", "views of ", shape.width, "x", shape.height,
                " px may need more than 8 GiB; crop or reduce them");
  }
  if (!std::ranges::all_of(light_field.data(), [](float value) { return std::abs(value) <= kLargest; })) {
    return fail(ErrorCode::kInvalidValue, "",
                "the light field contains NaN, infinity or values far outside [0, 1]; replace them first");
  }
  return {};
}

}  // namespace

ViewIndex middle_view(const Shape& shape) {
  return {shape.views_y / 2, shape.views_x / 2};
}

Result<DisparityMap> estimate_disparity(const LightField& light_field, const DisparityOptions& options,
                                        const ProgressFn& progress) {
  const ViewIndex view = options.view.value_or(middle_view(light_field.shape()));
  E2LF_RETURN_IF_ERROR(check(light_field, view, options));
  if (light_field.shape().channels != 1) return estimate_disparity(lightfield::to_grey(light_field), options, progress);

  std::optional<DisparityRange> range = options.range;
  if (!range) {
    E2LF_ASSIGN_OR_RETURN(range, find_range(light_field, view));
  }
  E2LF_ASSIGN_OR_RETURN(DisparityMap map, map_within(light_field, detail_of(light_field), view, *range, progress));
  // The detail of reconstructions is mostly noise, and the parallax is in their shading.
  if (mean_confidence(map) >= kUsualConfidence) return map;
  return map_within(light_field, light_field, view, *range, progress);
}

}  // namespace e2lf::depth
