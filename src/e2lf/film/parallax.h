// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
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

struct Quilt {
  size_t columns = 8, rows = 6;
};

/// The largest side of a quilt that displays with parallax read, in px.
inline constexpr size_t kMostQuiltPx = 8192;

/// Renders pictures from viewpoints along the middle row of views into one image, as displays with horizontal parallax
/// expect it: the leftmost viewpoint is at the bottom left, the next one to its right, and so on row by row upwards.
/// Fails with kUnsupported if the image has more than 2^28 px.
[[nodiscard]] Result<lightfield::Image> quilt_picture(const lightfield::LightField& light_field, const Quilt& quilt,
                                                      float still_px);

/// Returns the suffix that such displays read in the name of a quilt, e.g. "_qs8x6a1.33": columns, rows, and the aspect
/// ratio of a picture.
[[nodiscard]] std::string quilt_suffix(const lightfield::Shape& shape, const Quilt& quilt);

}  // namespace e2lf::film
