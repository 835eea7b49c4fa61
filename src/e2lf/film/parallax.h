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

/// `frames` viewpoints on the largest ellipse within the views, clockwise from its top; the last one is followed by
/// the first.
[[nodiscard]] std::vector<Viewpoint> orbit(const lightfield::Shape& shape, size_t frames);

/// From the left to the right of the middle row of views and back, slower at the ends; likewise without an end.
[[nodiscard]] std::vector<Viewpoint> sweep(const lightfield::Shape& shape, size_t frames);

/// Disparities from `first` to `last` and back, likewise.
[[nodiscard]] std::vector<float> focus_sweep(float first, float last, size_t frames);

/// What is seen from there: the four views around it, moved so that a plane of disparity `still_px` stands still,
/// mixed by their nearness. Between views what lies at another disparity d shows twice, d - still_px px apart. A
/// viewpoint outside of the views breaks the contract.
[[nodiscard]] lightfield::Image picture_from(const lightfield::LightField& light_field, const Viewpoint& viewpoint,
                                             float still_px);

struct Quilt {
  size_t columns = 8, rows = 6;
};

/// Pictures from viewpoints along the middle row of views in one image, as displays with horizontal parallax take it:
/// the leftmost viewpoint at the bottom left, the next one to its right, row by row upwards. Fails with kUnsupported
/// where that is more than 2^28 px.
[[nodiscard]] Result<lightfield::Image> quilt_picture(const lightfield::LightField& light_field, const Quilt& quilt,
                                                      float still_px);

/// What such displays read in the name of a quilt: "_qs8x6a1.33", columns, rows and the width of a picture over its
/// height.
[[nodiscard]] std::string quilt_suffix(const lightfield::Shape& shape, const Quilt& quilt);

}  // namespace e2lf::film
