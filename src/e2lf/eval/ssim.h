// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

namespace e2lf::eval {

/// The two variants of SSIM used in light-field papers (Wang et al., "Image quality assessment", TIP 2004), as computed
/// by scikit-image with data_range 1, K1 = 0.01, K2 = 0.03 and sample covariance (NP / (NP - 1), where NP is the number
/// of pixels of the window).
enum class SsimWindow {
  kUniform7,   ///< 7x7 mean, the default of scikit-image
  kGaussian11  ///< Gaussian with sigma 1.5 px, truncated at a radius of 5 px: gaussian_weights=True
};

/// Returns the side length of the window in px, 7 or 11. SSIM is not defined for smaller images.
[[nodiscard]] size_t ssim_window_size(SsimWindow window);

/// Computes the mean SSIM of two images [y, x] of the same size with values in [0, 1], over the pixels whose window
/// lies inside the image, so that border handling is irrelevant. It is computed in double, symmetric in the two images,
/// and 1 for equal images. Spans whose size is not height * width, or an image smaller than the window, break the
/// contract.
[[nodiscard]] double ssim(std::span<const float> image_a, std::span<const float> image_b, size_t height, size_t width,
                          SsimWindow window);

}  // namespace e2lf::eval
