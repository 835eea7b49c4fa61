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

/// The surface around each pixel as a plane of disparities, value + slope_y dy + slope_x dx; images [y, x].
struct Planes {
  lightfield::Image value, slope_y, slope_x;
  lightfield::Image weight;     ///< sum of the weights of the measurements on the plane
  lightfield::Image agreement;  ///< share of the weights around the pixel that lie on the plane, in [0, 1]
};

/// Returns planes parallel to the sensor at these disparities.
[[nodiscard]] Planes flat_planes(const lightfield::Image& disparity);

struct PlaneFit {
  int radius = 5;            ///< radius of the window, in samples
  int spacing = 1;           ///< distance of the samples, px
  float tolerance = 0.1F;    ///< px; a measurement at this distance from the plane counts a quarter
  float contrast = 0.05F;    ///< a pixel of such a difference in brightness counts a quarter
  float prior_error = 0.0F;  ///< px; weights the present planes like a measurement with this error; 0 = not
};

/// Refits the plane of each pixel to the measurements in a round window around it by weighted least squares.
/// Measurements off the present plane of the pixel, or of another brightness in `picture`, the grey view, belong to
/// another surface and get little weight. Edges thus stay
/// sharp, and surfaces without texture continue those around them.
void fit_planes(const Measurements& measurements, const lightfield::Image& picture, const PlaneFit& options,
                Planes& planes);

}  // namespace e2lf::depth
