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

/// The same rectangle of every view. Fails with kInvalidValue when it is empty or leaves the views.
[[nodiscard]] Result<LightField> crop(const LightField& light_field, const CropRegion& region);

/// Views first_view + step * i of each axis, i in [0, views).
struct ViewGrid {
  size_t first_view_y = 0, first_view_x = 0;
  size_t views_y = 0, views_x = 0;
  size_t step = 1;
};

/// A sub-grid of the views, e.g. the middle 8x8 of 9x9, or every second view; disparity per view step grows by `step`.
/// Fails with kInvalidValue when the grid is empty or asks for views that are not there.
[[nodiscard]] Result<LightField> select_views(const LightField& light_field, const ViewGrid& grid);

/// One view as an image; a view that is not there breaks the contract.
[[nodiscard]] Image view_image(const LightField& light_field, size_t view_y, size_t view_x);

}  // namespace e2lf::lightfield
