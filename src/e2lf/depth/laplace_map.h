// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/disparity.h"

namespace e2lf::depth {

/// Returns the map whose disparities have Laplace distributions with this location (px per view step) and logarithm of
/// the scale, [y, x] each. The expected error is the scale, from which the confidence follows: 0.5 at 0.07 px. The
/// range is that of the disparities.
[[nodiscard]] DisparityMap map_of_laplace(lightfield::Image location, const lightfield::Image& log_scale,
                                          const ViewIndex& view);

}  // namespace e2lf::depth
