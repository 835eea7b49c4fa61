// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// Disparities in px per view step.
struct DisparityRange {
  float least = 0, most = 0;
};

struct DisparityOptions {
  std::optional<ViewIndex> view;        ///< whose pixels get a disparity; absent = middle_view()
  std::optional<DisparityRange> range;  ///< what is looked for; absent = found within +-kFarthestPx
};

/// What is looked for where no range is given.
inline constexpr float kFarthestPx = 6.0F;

/// How far each pixel of a view moves from view to view, [y, x].
struct DisparityMap {
  lightfield::Image disparity;   ///< px per view step, the sign as in light_field.h: nearer is smaller
  lightfield::Image confidence;  ///< in [0, 1]: 0.5 where an error of 0.07 px is to be expected, 1 where none is
  ViewIndex view;
  DisparityRange range;  ///< that was looked for
  float residual =
      0;  ///< typical (1.48 times the median) difference of a view, moved by the disparities, from this one
};

/// The view (views_y / 2, views_x / 2): of 8x8 views there is none in the middle, (4, 4) is next to it.
[[nodiscard]] ViewIndex middle_view(const lightfield::Shape& shape);

/// The disparity of every pixel of a view. Colour is taken as grey.
/// 1. matching_costs() of equally spaced disparities, half a pixel apart in the farthest view.
/// 2. smooth_costs() along paths.
/// 3. Twice: measure() to fractions of the spacing, and fit_planes() to the measurements, in wide windows first.
/// The result is the same for any number of threads. Fails with kShape (a single view, no pixels), kNotFound (a view
/// that is not there), kInvalidValue (a range that is empty or not finite), kUnsupported (more memory than 8 GiB) and
/// kCancelled (a stop was asked for).
[[nodiscard]] Result<DisparityMap> estimate_disparity(const lightfield::LightField& light_field,
                                                      const DisparityOptions& options = {},
                                                      const ProgressFn& progress = {});

}  // namespace e2lf::depth
