// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// Returns the horizontal epipolar plane image (EPI) of one pixel row in one row of views as [view_x, x]. A point of
/// disparity d moves by +d px from each row of the EPI to the next. A view or pixel row that does not exist breaks the
/// contract.
[[nodiscard]] Image horizontal_epi(const LightFieldView& light_field, size_t view_y, size_t y);

/// Returns the vertical EPI of one pixel column in one column of views as [y, view_y]. A point moves down by d px from
/// each column of the EPI to the next.
[[nodiscard]] Image vertical_epi(const LightFieldView& light_field, size_t view_x, size_t x);

/// The place of the cut and the layout of the EPI picture.
struct EpiPictureOptions {
  size_t view_y = 0, view_x = 0;  ///< the view shown; the EPIs cut through its row and column of views
  size_t y = 0, x = 0;            ///< the pixel row and column that are cut
};

/// The enlargement of EPIs along the view axis.
inline constexpr size_t kEpiPxPerView = 6;

/// Returns the options for a cut through the middle: the view next to the middle of the grid (views / 2), and its
/// middle row and column.
[[nodiscard]] EpiPictureOptions middle_cut(const Shape& shape);

/// Draws a colour picture as usual in papers: the view with the cut row (blue) and column (green) marked, its
/// horizontal EPI below in a blue frame, and its vertical EPI to the right in a green one. The EPIs are enlarged by
/// kEpiPxPerView, and the parts are 4 px apart. A cut outside the light field breaks the contract.
[[nodiscard]] Image epi_picture(const LightFieldView& light_field, const EpiPictureOptions& options);

}  // namespace e2lf::lightfield
