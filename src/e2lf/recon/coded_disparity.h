// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

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

}  // namespace e2lf::recon
