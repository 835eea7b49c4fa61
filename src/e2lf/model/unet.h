// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/model/network.h"

namespace e2lf::model {

/// The sizes of a residual U-Net. `widths` and `blocks` have one entry per level, the first at half resolution.
struct UnetOptions {
  size_t input_channels = 9;
  size_t output_channels = 64;
  std::vector<size_t> widths = {80, 96, 128};
  std::vector<size_t> blocks = {2, 2, 2};  ///< residual blocks on each side; the last level has only one side
  size_t head_width =
      32;  ///< channels at full resolution before the last 3x3 convolution; 0 = the output follows directly
           ///< from half resolution by a transposed 2x2 convolution (`head_blocks` has no effect)
  size_t head_blocks = 0;  ///< residual blocks at full resolution
};

/// Builds a residual U-Net behind a pixel unshuffle by 2, with strided 2x2 convolutions down, transposed 2x2 ones up,
/// and additive skip connections. The head shuffles back to full resolution and ends in a 3x3 convolution, which
/// removes the grid pattern of the shuffle; a 1x1 skip connection from the inputs is added to its output. If
/// `head_blocks` is not 0, a 3x3 convolution of the inputs is added after the shuffle, followed by residual blocks at
/// full resolution, which are free of the grid. Each level halves the resolution, so image sizes must be multiples of
/// 2^levels.
[[nodiscard]] Network unet(const UnetOptions& options);

}  // namespace e2lf::model
