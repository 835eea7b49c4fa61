// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"

namespace e2lf::recon {

/// A picture [y, x] seen from a place on the aperture, in view steps relative to the centre of the views.
struct PlacedImage {
  std::vector<float> pixels;
  double view_y = 0, view_x = 0;
};

struct DisparitySearch {
  float largest = 3.0F;  ///< in px per view step, of either sign
  float step = 0.25F;
  size_t radius = 6;  ///< radius of the square window over which pictures are compared, in px
};

/// Estimates the disparity [y, x] as seen from the centre of the views: for each pixel, the candidate with the smallest
/// relative difference between the pictures over the window. It is 0 everywhere if all pictures have the same place.
[[nodiscard]] std::vector<float> coded_disparity(std::span<const PlacedImage> images, size_t height, size_t width,
                                                 const DisparitySearch& search);

/// Samples a picture bilinearly at (y, x). The coordinates are clamped to the picture.
[[nodiscard]] float sample_bilinear(std::span<const float> pixels, size_t height, size_t width, float y, float x);

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

}  // namespace e2lf::recon
