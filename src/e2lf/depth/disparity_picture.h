// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "e2lf/depth/disparity.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// Returns a picture of disparities for display, with the colours of all pictures of disparities (also those of the
/// viewer): perceptually uniform from yellow for near (range.least) through green to dark violet for far (range.most),
/// and grey where the disparity is unknown (not finite).
[[nodiscard]] lightfield::Image colour_picture(const lightfield::Image& disparity, const DisparityRange& range);

/// Returns colour_picture() with a legend on its right, on white: the unit, and a bar from near on top to far with two
/// to five numbers, of which the first is followed by "near" and the last by "far". A picture that is less high than
/// its legend is extended by white.
[[nodiscard]] lightfield::Image picture_with_scale(const lightfield::Image& disparity, const DisparityRange& range);

/// Returns the range of disparities that the colours of a map span, on the command line as in the viewer: that of the
/// pixels with a confidence of at least kLeastConfidence (of all pixels if these are fewer than a twentieth), without a
/// hundredth at either end. Only finite disparities count; (0, 0) if there are none.
[[nodiscard]] DisparityRange shown_range(const lightfield::Image& disparity, const lightfield::Image& confidence);

/// Returns the same range of a map whose pixels are all certain.
[[nodiscard]] DisparityRange shown_range(const lightfield::Image& disparity);

/// Returns the text in DejaVu Sans, black on white, as a grey image of this height, from the ascenders to the
/// descenders. Only digits, '-', '.', ' ' and the letters of "near", "far" and "px per view step" exist; any other
/// character, and a height of 0 or above 64, breaks the contract.
[[nodiscard]] lightfield::Image text_picture(std::string_view text, size_t height);

}  // namespace e2lf::depth
