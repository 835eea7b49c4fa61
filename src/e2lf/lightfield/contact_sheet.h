// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// A smaller copy of an image in which each pixel is the mean of the rectangle it covers (box filter with fractional
/// edges). No side may be 0 or larger than that of the image: that breaks the contract.
[[nodiscard]] Image shrink(const Image& image, size_t width, size_t height);

struct ContactSheetOptions {
  size_t max_width = 1600;  ///< of the sheet; views are never enlarged
  size_t separator_px = 2;  ///< between views
  float separator_value = 1;
};

/// All views in one picture, in the order of the aperture, each scaled down by the same factor so that the sheet is at
/// most max_width wide. A max_width with less than a pixel for each view, or a light field without pixels, breaks the
/// contract.
[[nodiscard]] Image contact_sheet(const LightField& light_field, const ContactSheetOptions& options = {});

}  // namespace e2lf::lightfield
