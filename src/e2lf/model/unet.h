// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/model/network.h"

namespace e2lf::model {

/// Sizes of a residual U-Net; `widths` and `blocks` have one entry per level, the first at 1/2 resolution.
struct UnetOptions {
  size_t input_channels = 9;
  size_t output_channels = 64;
  std::vector<size_t> widths = {80, 96, 128};
  std::vector<size_t> blocks = {2, 2, 2};  ///< residual blocks on each side; the last level has one side
  size_t head_width = 32;                  ///< channels at full resolution before the last 3x3 convolution
  size_t head_blocks = 0;                  ///< residual blocks at full resolution
};

/// A residual U-Net behind a pixel unshuffle by 2: strided 2x2 convolutions down, transposed 2x2 ones up, skips added.
/// The head shuffles back to full resolution and ends in a 3x3 convolution there, which leaves no grid of the shuffle;
/// a 1x1 skip from the inputs is added to it. With `head_blocks` a 3x3 convolution of the inputs joins after the
/// shuffle and residual blocks follow there, which know no grid at all. Each level halves the resolution, so images are
/// multiples of 2^levels.
[[nodiscard]] Network unet(const UnetOptions& options);

}  // namespace e2lf::model
