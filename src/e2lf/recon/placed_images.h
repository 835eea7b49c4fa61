// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/coded_intensities.h"
#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/recon/coded_disparity.h"

namespace e2lf::recon {

/// Returns the middle of `views` views along an axis.
[[nodiscard]] inline double view_centre(size_t views) {
  return (static_cast<double>(views) - 1) / 2;
}

/// Coded images as pictures seen from the centres of light of their patterns, divided by the share of open cells.
struct PlacedImages {
  std::vector<PlacedImage> images;
  std::vector<size_t> patterns;  ///< the number of the pattern of each; black patterns are omitted
};

[[nodiscard]] PlacedImages place_images(const capture::CodedIntensities& intensities, const capture::Codes& codes);

/// Returns the number of the first black pattern. Fails with kInvalidValue if none is black, and with kShape if images
/// and patterns do not match or the images are empty.
[[nodiscard]] Result<size_t> black_pattern(const capture::EventImages& images, const capture::Codes& codes);

/// Returns the disparity [y, x], which is given as seen from the centre of the views, at the point that each pixel of a
/// view at (view_y, view_x) from the centre shows.
[[nodiscard]] std::vector<float> disparity_in_view(const std::vector<float>& disparity, size_t height, size_t width,
                                                   double view_y, double view_x);

}  // namespace e2lf::recon
