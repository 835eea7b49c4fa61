// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>

#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::learn {

/// Constants of event pixels per sample, on the device of the light fields.
struct PixelSamples {
  torch::Tensor is_pixel;      ///< bool [batch]: the others are of the paper's models
  torch::Tensor constants;     ///< float32 [batch, capture::kNumPixelConstants]
  torch::Tensor transmission;  ///< float32 [batch, number of codes]: that of black is 1
  int64_t cycles = 1;          ///< counts are means over so many cycles

  /// One constant, float32 [batch, 1, 1].
  [[nodiscard]] torch::Tensor at(capture::PixelConstant constant) const {
    return constants.select(1, static_cast<int64_t>(constant)).reshape({-1, 1, 1});
  }
};

/// Returns the mean event images [batch, P - 1, y, x] of pixels that follow the light with a lag, in a closed form of
/// the camera's cycle: the inverse of the last code, black, then codes 2..N, and for a whole cycle their inverses and
/// black again. Coded intensities [batch, P, y, x] are those of the N codes (P = N) or of capture::whole_cycle() of
/// them (P = 2N + 1), the first black; `full` [batch, y, x] is the intensity with all cells open. An inverse lets
/// through what its code holds back of the open aperture's light. The change to black makes the OFF events that take
/// the reference down to the level.
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
