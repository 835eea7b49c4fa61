// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/measurement.h"

namespace e2lf::depth {

/// The surface around each pixel as a plane of disparities: value + slope_y dy + slope_x dx; images [y, x].
struct Planes {
  lightfield::Image value, slope_y, slope_x;
  lightfield::Image weight;     ///< of all measurements that made the plane
  lightfield::Image agreement;  ///< the share of the weights around the pixel that lies on the plane, in [0, 1]
};

/// Planes that face the camera at these disparities.
[[nodiscard]] Planes flat_planes(const lightfield::Image& disparity);

struct PlaneFit {
  int radius = 5;            ///< of the window, in samples
  int spacing = 1;           ///< of the samples, px
  float tolerance = 0.1F;    ///< px; a measurement so far from the plane counts a quarter
  float prior_error = 0.0F;  ///< px; trust in the planes as they are, as in a measurement with this error; 0 = none
};

/// Fits the plane of each pixel anew to the measurements in a round window around it, by weighted least squares. What
/// lies off the pixel's present plane, another surface, has little weight: so edges stay sharp, and where there is no
/// texture the surface goes on as it does around.
void fit_planes(const Measurements& measurements, const PlaneFit& options, Planes& planes);

}  // namespace e2lf::depth
