// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

namespace e2lf::learn {

/// Disparity over the central picture: centre + slope . (position - centre of the picture), px per view step.
struct Plane {
  double centre = 0, slope_y = 0, slope_x = 0;
};

/// A textured plane; maps are float32 [side, side] around the centre of the picture.
struct Surface {
  Plane plane;
  torch::Tensor brightness;
  torch::Tensor coverage;  ///< in [0, 1], clamped after sampling; undefined: everywhere
};

/// What the 8x8 views see of surfaces given back to front: float32 [64, size, size], a little beyond the range of the
/// maps where interpolation overshoots. The first surface, and no other, has no coverage; all maps have one size and
/// device, else the contract is broken. Maps are sampled bicubically (bilinear interpolation takes the finest detail
/// away wherever a view looks between pixels, and cameras do not); beyond their border they repeat it. On CPUs by
/// render_view() where it was built, on all threads; else the reference.
[[nodiscard]] torch::Tensor views_of(const std::vector<Surface>& surfaces, int64_t size);

/// The same in torch's own operations, on any device; render_view() differs from it by 0.002 at most on white noise.
[[nodiscard]] torch::Tensor views_of_reference(const std::vector<Surface>& surfaces, int64_t size);

}  // namespace e2lf::learn
