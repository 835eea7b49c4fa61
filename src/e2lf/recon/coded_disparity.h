// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace e2lf::recon {

/// A picture [y, x] taken from a place on the aperture, in view steps relative to the centre of the views.
struct PlacedImage {
  std::vector<float> pixels;
  double view_y = 0, view_x = 0;
};

struct DisparitySearch {
  float largest = 3.0F;  ///< in px per view step, either sign
  float step = 0.25F;
  size_t radius = 6;  ///< of the square window that is compared, in px
};

/// The disparity [y, x] seen from the centre of the views: for each pixel the candidate with the least relative
/// difference between the pictures over the window. All 0 when fewer than two pictures differ in place.
[[nodiscard]] std::vector<float> coded_disparity(std::span<const PlacedImage> images, size_t height, size_t width,
                                                 const DisparitySearch& search);

/// Bilinear sample at (y, x), coordinates limited to the picture.
[[nodiscard]] float sample_bilinear(std::span<const float> pixels, size_t height, size_t width, float y, float x);

}  // namespace e2lf::recon
