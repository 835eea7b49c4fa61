// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>

#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::learn {

/// Constants of the physical pixels of each sample, on the device of the light fields unless stated otherwise.
struct PixelSamples {
  torch::Tensor is_pixel;      ///< bool [batch] on the CPU; false for samples of the paper's models
  torch::Tensor constants;     ///< float32 [batch, capture::kNumPixelConstants]
  torch::Tensor transmission;  ///< float32 [batch, number of codes]; that of black is 1
  int64_t cycles = 1;          ///< number of cycles over which the counts are averaged

  /// Returns one constant, float32 [batch, 1, 1].
  [[nodiscard]] torch::Tensor at(capture::PixelConstant constant) const {
    return constants.select(1, static_cast<int64_t>(constant)).reshape({-1, 1, 1});
  }
};

/// Computes the event images [batch, P - 1, y, x], averaged over the cycles, of pixels that follow the light with a
/// lag. The camera's cycle has a closed-form solution: the inverse of the last code, black, codes 2 to N, and for a
/// whole cycle their inverses and black again. `intensities` [batch, P, y, x] are the coded intensities of the N codes
/// (P = N) or of capture::whole_cycle() of them (P = 2N + 1); the first is black. `full` is the intensity with all
/// cells open, [batch, y, x], or [batch, P, y, x] if it changes from pattern to pattern. An inverse transmits the light
/// of the open aperture that its code blocks. The change to black causes the OFF events that bring the reference down
/// to the level.
///
/// The log intensity u of the photoreceptor obeys du/dt = K (J - exp u) with J = (I + eps) / eps. This is linear in w =
/// exp(-u), so that w relaxes to 1 / J at the rate K J. The level of the amplifier relaxes to u at its own rate. At the
/// end of a pattern, the level with its noise is compared with the reference: count = trunc((level - reference) /
/// threshold), and the reference moves by threshold * count. After black, the reference lies up to reset_span OFF
/// thresholds above the level. The function draws from torch's generator: thresholds once per pixel, everything else
/// once per cycle. Rounding has the gradient of the identity.
[[nodiscard]] torch::Tensor simulate_pixel_events(const torch::Tensor& intensities, const torch::Tensor& full,
                                                  const PixelSamples& samples);

}  // namespace e2lf::learn
