// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// A range of disparities in px per view step.
struct DisparityRange {
  float least = 0, most = 0;
};

struct DisparityOptions {
  std::optional<ViewIndex> view;        ///< the view whose pixels get a disparity; if absent, middle_view()
  std::optional<DisparityRange> range;  ///< the range searched; if absent, it is found within +-kFarthestPx
};

/// The search range if none is given.
inline constexpr float kFarthestPx = 6.0F;

/// The confidence from which on points are shown unless another one is given, also in the viewer (viewer/src/state.ts):
/// an expected error of 0.3 px.
inline constexpr float kLeastConfidence = 0.05F;

/// The disparity of each pixel of a view, [y, x].
struct DisparityMap {
  lightfield::Image disparity;   ///< px per view step, with the sign of light_field.h: smaller for nearer points
  lightfield::Image confidence;  ///< in [0, 1]: 0.5 where the expected error is 0.07 px, 1 where it is zero
  ViewIndex view;
  DisparityRange range;  ///< the range that was searched
  float residual = 0;    ///< robust standard deviation of the difference between this view and a view shifted by the
                         ///< disparities
};

/// Returns the view (views_y / 2, views_x / 2). 8x8 views have no exact middle; (4, 4) is next to it.
[[nodiscard]] ViewIndex middle_view(const lightfield::Shape& shape);

/// Estimates the disparity of every pixel of a view. Colour is converted to grey. Views are compared without most of
/// their shading, or as they are if the confidence of the result would be low, as in reconstructions from events.
/// 1. matching_costs() are computed for equally spaced disparities, half a pixel apart in the farthest view.
/// 2. smooth_costs() smooths them along paths.
/// 3. Twice, measure() refines them to fractions of the spacing, and fit_planes() fits planes to the result.
/// The result does not depend on the number of threads. Fails with kShape (a single view, or no pixels), kNotFound (a
/// view that does not exist), kInvalidValue (a range that is empty or not finite, NaN, infinity or values far outside
/// [0, 1]), kUnsupported (more than 8 GiB of memory) and kCancelled (a stop was requested).
[[nodiscard]] Result<DisparityMap> estimate_disparity(const lightfield::LightField& light_field,
                                                      const DisparityOptions& options = {},
                                                      const ProgressFn& progress = {});

}  // namespace e2lf::depth
