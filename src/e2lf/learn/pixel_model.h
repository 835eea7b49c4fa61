// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>

#include "e2lf/capture/camera.h"

namespace e2lf::learn {

/// Constants of event pixels per sample, on the device of the light fields.
struct PixelSamples {
  torch::Tensor is_pixel;      ///< bool [batch]: the others are of the paper's models
  torch::Tensor constants;     ///< float32 [batch, capture::kNumPixelConstants]
  torch::Tensor transmission;  ///< float32 [batch, N]: that of black is 1
  int64_t cycles = 1;          ///< counts are means over so many cycles

  /// One constant, float32 [batch, 1, 1].
  [[nodiscard]] torch::Tensor at(capture::PixelConstant constant) const {
    return constants.select(1, static_cast<int64_t>(constant)).reshape({-1, 1, 1});
  }
};

/// Mean event images [batch, N - 1, y, x] of pixels that follow the light with a lag, a closed form of the camera's
/// cycle: the inverse of the last pattern, black, then patterns 2..N. Coded intensities [batch, N, y, x], the first
/// black; `full` [batch, y, x] is the intensity with all cells open.
///
/// The photoreceptor's log intensity u obeys du/dt = K (J - exp u), J = (I + eps) / eps, which is linear in w =
/// exp(-u): w relaxes to 1 / J at the rate K J. The amplifier's level relaxes to u at its own rate. At the end of a
/// pattern the level with its noise is compared with the reference, count = trunc((level - reference) / threshold),
/// which moves by threshold * count. Black leaves the reference somewhere within reset_span OFF thresholds above the
/// level. Draws from torch's generator: thresholds once per pixel, the rest in each cycle. Rounding has the gradient of
/// the identity.
[[nodiscard]] torch::Tensor simulate_pixel_events(const torch::Tensor& intensities, const torch::Tensor& full,
                                                  const PixelSamples& samples);

}  // namespace e2lf::learn
