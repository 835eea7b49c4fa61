// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>

#include "e2lf/learn/data/draws.h"

namespace e2lf::learn {

/// The largest absolute disparity of most scenes of plenoptic cameras, px per view step.
inline constexpr double kPlenopticDisparity = 0.7;

/// Simulates a light field as recorded and decoded by a plenoptic camera. docs/experiments/plenoptic-scenes.md contains
/// the measurements from which the ranges follow.
struct PlenopticCamera {
  double gamma = 1.0;            ///< exponent of the tone curve
  double corner_contrast = 1.0;  ///< contrast of details in the corner views, relative to the centre of the aperture
  double blur_y_px = 0.0;        ///< standard deviations of the blur by demosaicing and resampling
  double blur_x_px = 0.0;
  double corner_brightness = 1.0;  ///< brightness of the corners of the image, relative to its centre
  double grain = 0.0;              ///< standard deviation, independent in each view
  uint64_t grain_seed = 0;         ///< seed of torch's generator for the grain

  /// Returns the light field as the camera shows it, for views float32 [64, y, x] in [0, 1].
  [[nodiscard]] torch::Tensor show(const torch::Tensor& views) const;
};

/// Returns a camera with random properties in the measured ranges.
[[nodiscard]] PlenopticCamera random_plenoptic_camera(Draws& draws);

}  // namespace e2lf::learn
