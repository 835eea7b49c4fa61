// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

namespace e2lf::learn {

/// Disparity over the central picture: centre + slope . (position - centre of the picture), px per view step.
struct Plane {
  double centre = 0, slope_y = 0, slope_x = 0;
};

/// A textured plane; maps are float32 [side, side] around the centre of the picture, `side` the same for all.
struct Surface {
  Plane plane;
  torch::Tensor brightness;
  torch::Tensor coverage;  ///< in [0, 1], clamped after sampling; undefined: everywhere
};

/// What the 8x8 views see of surfaces given back to front, the first without coverage: float32 [64, size, size].
/// Maps are sampled bicubically (bilinear interpolation takes the finest detail away wherever a view looks between
/// pixels, and cameras do not); beyond their border they repeat it. On the device of the maps.
[[nodiscard]] torch::Tensor views_of(const std::vector<Surface>& surfaces, int64_t size);

/// The same in torch's own operations: what runs on a GPU, and the reference for the CPU's kernel.
[[nodiscard]] torch::Tensor views_of_reference(const std::vector<Surface>& surfaces, int64_t size);

}  // namespace e2lf::learn
