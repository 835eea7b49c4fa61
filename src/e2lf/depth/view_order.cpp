// SPDX-License-Identifier: MIT
#include "e2lf/depth/view_order.h"

#include <cmath>
#include <numeric>
#include <vector>

#include "e2lf/base/threads.h"
#include "e2lf/lightfield/views.h"

namespace e2lf::depth {
namespace {

using lightfield::Image;
using lightfield::LightField;

/// The evidence of neighbouring pixels within an area of this size counts as one piece.
constexpr int kAreaPx = 16;
constexpr float kLeastConfidence = 0.2F;
constexpr int kLeastOverlapPx = 2, kMostOverlapPx = 64;

Image grey_view(const LightField& light_field, size_t view_y, size_t view_x) {
  return lightfield::to_grey(lightfield::view_image(light_field, view_y, view_x));
}

/// Samples bilinearly; NaN outside of the picture.
float sample(const Image& picture, float y, float x) {
  const auto width = static_cast<float>(picture.width), height = static_cast<float>(picture.height);
  if (!(y >= 0 && x >= 0 && y < height - 1 && x < width - 1)) return std::nanf("");
  const auto row = static_cast<size_t>(y), column = static_cast<size_t>(x);
  const float fy = y - static_cast<float>(row), fx = x - static_cast<float>(column);
  const float* const above = picture.pixels.data() + row * picture.width + column;
  const float* const below = above + picture.width;
  return (1 - fy) * ((1 - fx) * above[0] + fx * above[1]) + fy * ((1 - fx) * below[0] + fx * below[1]);
}

/// A direction in which to look past the reference view: a view far to one side of it, and the opposite one.
class Direction {
 public:
  Direction(const LightField& light_field, const DisparityMap& map, const Image& reference, int step_y, int step_x,
            int views)
      : map_(map), reference_(reference), step_y_(step_y), step_x_(step_x), views_(static_cast<float>(views)) {
    const auto at = [&](int sign) {
      return grey_view(light_field, static_cast<size_t>(static_cast<int>(map.view.y) + sign * step_y * views),
                       static_cast<size_t>(static_cast<int>(map.view.x) + sign * step_x * views));
    };
    beyond_ = at(1);
    opposite_ = at(-1);
  }

  /// Adds the evidence of a row, which is positive if the smaller disparity is in front.
  void add_row(size_t y, std::vector<float>& areas) const {
    const Image& disparity = map_.disparity;
    const float span = views_ * (map_.range.most - map_.range.least);
    const int most = std::min(static_cast<int>(span) + 1, kMostOverlapPx);
    for (size_t x = 0; x < disparity.width; ++x) {
      if (!is_sure(y, x)) continue;
      const float far = disparity.pixels[y * disparity.width + x];
      for (int overlap = kLeastOverlapPx; overlap <= most; ++overlap) {
        const int other_y = static_cast<int>(y) + step_y_ * overlap, other_x = static_cast<int>(x) + step_x_ * overlap;
        if (other_y < 0 || other_x < 0 || other_y >= static_cast<int>(disparity.height) ||
            other_x >= static_cast<int>(disparity.width)) {
          break;
        }
        const float near =
            disparity.pixels[static_cast<size_t>(other_y) * disparity.width + static_cast<size_t>(other_x)];
        // Both pixels must coincide in the view beyond.
        if (std::abs((far - near) * views_ - static_cast<float>(overlap)) > 0.5F) continue;
        if (!is_sure(static_cast<size_t>(other_y), static_cast<size_t>(other_x))) continue;
        areas[y / kAreaPx * areas_per_row() + x / kAreaPx] += evidence(y, x, far, near);
      }
    }
  }

  [[nodiscard]] size_t areas_per_row() const { return (map_.disparity.width + kAreaPx - 1) / kAreaPx; }

 private:
  [[nodiscard]] bool is_sure(size_t y, size_t x) const {
    const size_t i = y * map_.disparity.width + x;
    if (map_.confidence.pixels[i] < kLeastConfidence) return false;
    const float moved = -views_ * map_.disparity.pixels[i];
    const float seen = sample(opposite_, static_cast<float>(y) + static_cast<float>(step_y_) * moved,
                              static_cast<float>(x) + static_cast<float>(step_x_) * moved);
    return std::abs(seen - reference_.pixels[i]) < tolerance();
  }

  [[nodiscard]] float tolerance() const { return 2 * std::max(map_.residual, 0.004F); }

  /// Returns the evidence of a pixel with the larger disparity and the one with the smaller disparity that coincides
  /// with it.
  [[nodiscard]] float evidence(size_t y, size_t x, float larger, float smaller) const {
    const auto row = static_cast<float>(y), column = static_cast<float>(x);
    const auto dy = static_cast<float>(step_y_) * views_, dx = static_cast<float>(step_x_) * views_;
    const float seen = sample(beyond_, row + dy * larger, column + dx * larger);
    const float of_larger = reference_.pixels[y * reference_.width + x];
    const float of_smaller = sample(reference_, row + dy * (larger - smaller), column + dx * (larger - smaller));
    const float difference = std::abs(of_larger - of_smaller);
    if (!(difference > 3 * tolerance())) return 0;  // also if NaN
    const float off_larger = std::abs(seen - of_larger), off_smaller = std::abs(seen - of_smaller);
    if (!(std::min(off_larger, off_smaller) < difference / 3)) return 0;
    return off_smaller < off_larger ? 1.0F : -1.0F;
  }

  const DisparityMap& map_;
  const Image& reference_;
  int step_y_, step_x_;
  float views_;
  Image beyond_, opposite_;
};

OcclusionSign judge(const std::vector<float>& areas) {
  constexpr size_t kFewestPlaces = 9;
  constexpr float kLeastDeviations = 3.0F, kLeastShare = 0.75F;
  OcclusionSign sign;
  double sum = 0, all = 0, squares = 0;
  for (const float area : areas) {
    if (area == 0) continue;
    // The square root prevents a single large area with an error from outvoting many small ones.
    const double weight = std::copysign(std::sqrt(std::abs(double{area})), double{area});
    sum += weight;
    all += std::abs(weight);
    squares += weight * weight;
    ++sign.places;
  }
  if (sign.places == 0) return sign;
  sign.smaller_in_front = static_cast<float>(0.5 + 0.5 * sum / all);
  sign.deviations = static_cast<float>(sum / std::sqrt(squares));
  if (sign.places < kFewestPlaces || std::abs(sign.deviations) < kLeastDeviations || sign.confidence() < kLeastShare) {
    return sign;
  }
  sign.verdict = sum > 0 ? OcclusionSign::Verdict::kUpright : OcclusionSign::Verdict::kTurned;
  return sign;
}

}  // namespace

OcclusionSign occlusion_sign(const LightField& light_field, const DisparityMap& map) {
  const lightfield::Shape& shape = light_field.shape();
  const int views_y = static_cast<int>(std::min(map.view.y, shape.views_y - 1 - map.view.y));
  const int views_x = static_cast<int>(std::min(map.view.x, shape.views_x - 1 - map.view.x));
  const Image reference = grey_view(light_field, map.view.y, map.view.x);
  std::vector<float> areas;
  for (int step_y = -1; step_y <= 1; ++step_y) {
    for (int step_x = -1; step_x <= 1; ++step_x) {
      const int views = step_y == 0 ? views_x : step_x == 0 ? views_y : std::min(views_y, views_x);
      if ((step_y == 0 && step_x == 0) || views == 0) continue;
      const Direction direction(light_field, map, reference, step_y, step_x, views);
      const size_t rows_of_areas = (shape.height + kAreaPx - 1) / kAreaPx;
      areas.resize(rows_of_areas * direction.areas_per_row());
      parallel_for(rows_of_areas, 1, [&](size_t begin, size_t end) {
        for (size_t y = begin * kAreaPx; y < std::min(end * kAreaPx, shape.height); ++y) direction.add_row(y, areas);
      });
    }
  }
  return judge(areas);
}

double mean_confidence(const DisparityMap& map) {
  const auto& values = map.confidence.pixels;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace e2lf::depth
