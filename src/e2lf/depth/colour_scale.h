// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/disparity.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// Returns colour_picture() with a scale on its right, on white: a bar of the colours from range.most on top to
/// range.least, with five numbers unless the picture is less than 64 px high.
[[nodiscard]] lightfield::Image picture_with_scale(const lightfield::Image& disparity, const DisparityRange& range);

}  // namespace e2lf::depth
