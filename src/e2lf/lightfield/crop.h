// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// A rectangle of pixels, [y, y + height) x [x, x + width).
struct CropRegion {
  size_t y = 0, x = 0, height = 0, width = 0;
};

/// Cuts the same rectangle out of every view. Fails with kInvalidValue if it is empty or extends beyond the views.
[[nodiscard]] Result<LightField> crop(const LightField& light_field, const CropRegion& region);

/// A grid of views: first_view + step * i along each axis, for i in [0, views).
struct ViewGrid {
  size_t first_view_y = 0, first_view_x = 0;
  size_t views_y = 0, views_x = 0;
  size_t step = 1;
};

/// Selects a sub-grid of the views, e.g. the central 8x8 of 9x9, or every second view, where the disparity per view
/// step grows by the factor `step`. Fails with kInvalidValue if the grid is empty or extends beyond the existing views.
[[nodiscard]] Result<LightField> select_views(const LightField& light_field, const ViewGrid& grid);

/// Returns one view as an image. A view that does not exist breaks the contract.
[[nodiscard]] Image view_image(const LightField& light_field, size_t view_y, size_t view_x);

}  // namespace e2lf::lightfield
