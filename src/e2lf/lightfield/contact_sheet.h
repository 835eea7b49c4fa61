// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// Shrinks an image by a box filter: each pixel is the mean of the rectangle that it covers, with fractional edges. A
/// width or height that is 0 or larger than that of the image breaks the contract.
[[nodiscard]] Image shrink(const Image& image, size_t width, size_t height);

struct ContactSheetOptions {
  size_t max_width = 1600;  ///< largest width of the sheet, in px; views are never enlarged
  size_t separator_px = 2;  ///< between views
  float separator_value = 1;
};

/// Returns all views in one picture, in the order of the aperture, scaled down by a common factor so that the sheet is
/// at most max_width wide. The contract is broken if max_width leaves less than a pixel per view or if the light field
/// has no pixels.
[[nodiscard]] Image contact_sheet(const LightFieldView& light_field, const ContactSheetOptions& options = {});

/// Returns the image with each pixel repeated times_y x times_x times.
[[nodiscard]] Image enlarged(const Image& image, size_t times_y, size_t times_x);

}  // namespace e2lf::lightfield
