// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// What the grey values of all views say of the disparity at each pixel by itself, [y, x].
struct Measurements {
  lightfield::Image value;   ///< px per view step
  lightfield::Image weight;  ///< noise^2 / weight is the variance of `value`; 0 where there is no texture
  float noise = 0;           ///< the standard deviation of a grey value
};

/// One step of Gauss and Newton from a disparity that is nearly right: with the residuals r_v = L_v(p + d k_v) - L_r(p)
/// of the views v, k_v = v - reference, and their slopes g_v = k_v . grad L, d moves by -sum w g r / sum w g^2. Views
/// whose residual is large, because something hides the pixel from them, have little weight w. A step is 0.25 px at
/// most.
[[nodiscard]] Measurements measure(const lightfield::LightField& light_field, const ViewIndex& reference,
                                   const lightfield::Image& disparity);

}  // namespace e2lf::depth
