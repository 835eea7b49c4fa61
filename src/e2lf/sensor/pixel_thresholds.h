// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/capture/profile/camera.h"

namespace e2lf::sensor {

/// The contrast thresholds of one pixel, natural logarithm.
struct PixelThresholds {
  float on = 0.0F, off = 0.0F;
};

/// Those of a pixel of the camera whose unequal pixels `map_seed` stands for: from CounterRng(map_seed, 2^33).
[[nodiscard]] PixelThresholds draw_thresholds(const capture::PixelConstants& constants, uint64_t map_seed,
                                              uint64_t pixel);

}  // namespace e2lf::sensor
