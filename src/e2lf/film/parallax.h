// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::film {

/// A viewpoint in the plane of the views, in view steps from view (0, 0).
struct Viewpoint {
  float y = 0, x = 0;
};

/// Returns `frames` viewpoints on the largest ellipse within the views, clockwise from its top. The path is closed.
[[nodiscard]] std::vector<Viewpoint> orbit(const lightfield::Shape& shape, size_t frames);

/// Returns viewpoints from the left to the right of the middle row of views and back, slower at the ends. The path is
/// closed.
[[nodiscard]] std::vector<Viewpoint> sweep(const lightfield::Shape& shape, size_t frames);

/// Returns disparities from `first` to `last` and back, slower at the ends. The sequence is closed.
[[nodiscard]] std::vector<float> focus_sweep(float first, float last, size_t frames);

/// Renders the light field from `viewpoint` by blending its four neighbouring views with bilinear weights, each shifted
/// so that a plane of disparity `still_px` does not move. Between views, a point at another disparity d appears twice,
/// d - still_px px apart. A viewpoint outside of the views breaks the contract.
[[nodiscard]] lightfield::Image picture_from(const lightfield::LightField& light_field, const Viewpoint& viewpoint,
                                             float still_px);

}  // namespace e2lf::film
