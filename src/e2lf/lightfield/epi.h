// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// The horizontal epipolar plane image of one row of pixels in one row of views: [view_x, x], so a point of disparity d
/// moves by +d px from each row to the next. Views or rows that are not there break the contract.
[[nodiscard]] Image horizontal_epi(const LightField& light_field, size_t view_y, size_t y);

/// The vertical one of a column of pixels in a column of views: [y, view_y], a point moves down by d px from each
/// column to the next.
[[nodiscard]] Image vertical_epi(const LightField& light_field, size_t view_x, size_t x);

/// Where the EPI picture is cut and how it looks.
struct EpiPictureOptions {
  size_t view_y = 0, view_x = 0;  ///< the view shown, whose row and column of views are cut
  size_t y = 0, x = 0;            ///< the pixel row and column that are cut
  size_t px_per_view = 6;         ///< how much EPIs are enlarged along the view axis
  size_t gap_px = 4;              ///< white space between the parts
};

/// The options for a cut through the middle: the view next to the middle of the grid (views / 2), the middle row and
/// column.
[[nodiscard]] EpiPictureOptions middle_cut(const Shape& shape);

/// A picture as papers show it, in colour: the view with the cut row (blue) and column (green) drawn on it, its
/// horizontal EPI below in a blue frame, its vertical EPI at the right in a green one. Size: width + gap + views_y *
/// px_per_view by height + gap + views_x * px_per_view. A cut outside the light field breaks the contract.
[[nodiscard]] Image epi_picture(const LightField& light_field, const EpiPictureOptions& options);

}  // namespace e2lf::lightfield
