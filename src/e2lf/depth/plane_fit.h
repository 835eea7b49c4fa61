// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/measurement.h"

namespace e2lf::depth {

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
