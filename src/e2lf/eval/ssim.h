// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

namespace e2lf::eval {

/// The two variants of SSIM that light-field papers quote (Wang et al., "Image quality assessment", TIP 2004), as
/// scikit-image computes them with data_range 1, K1 = 0.01, K2 = 0.03 and sample covariance (NP / (NP - 1), NP = pixels
/// of the window).
enum class SsimWindow {
  kUniform7,   ///< 7x7 mean, scikit-image's default
  kGaussian11  ///< Gaussian of sigma 1.5 px cut at radius 5 px: gaussian_weights=True
};

/// The side of the window in px: 7 or 11. Smaller images have no SSIM.
[[nodiscard]] size_t ssim_window_size(SsimWindow window);

/// Mean SSIM of two images [y, x] of the same size with values in [0, 1], over the pixels whose window lies inside the
/// image; so the way borders are filled does not matter. Computed in double. Symmetric in the two images; 1 when equal.
/// Spans that are not height * width, or an image smaller than the window, break the contract.
[[nodiscard]] double ssim(std::span<const float> image_a, std::span<const float> image_b, size_t height, size_t width,
                          SsimWindow window);

}  // namespace e2lf::eval
