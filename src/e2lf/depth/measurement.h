// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// The disparity measured from the grey values of all views at each pixel independently, [y, x].
struct Measurements {
  lightfield::Image value;   ///< px per view step
  lightfield::Image weight;  ///< noise^2 / weight is the variance of `value`; 0 without texture, or if no view agrees
  float noise = 0;           ///< the standard deviation of a grey value
};

/// Performs one Gauss-Newton step from a disparity that is approximately right. With the residuals r_v = L_v(p + d k_v)
/// - L_r(p) of the views v, k_v = v - reference, and their slopes g_v = k_v . grad L, d changes by -sum w g r / sum w
/// g^2. Views with a large residual, from which the pixel is hidden, have a small weight w. A step is at most 0.25 px.
[[nodiscard]] Measurements measure(const lightfield::LightField& light_field, const ViewIndex& reference,
                                   const lightfield::Image& disparity);

/// Returns the robust standard deviation (1.48 times the median) of the difference between the reference and the other
/// views, shifted by the disparities; at least that of 8-bit quantisation.
[[nodiscard]] float typical_residual(const lightfield::LightField& light_field, const ViewIndex& reference,
                                     const lightfield::Image& disparity);

}  // namespace e2lf::depth
