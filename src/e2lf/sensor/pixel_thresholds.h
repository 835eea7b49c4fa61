// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::sensor {

/// The contrast thresholds of one pixel, in natural logarithm.
struct PixelThresholds {
  float on = 0.0F, off = 0.0F;
};

/// Draws the thresholds of a pixel from CounterRng(map_seed, 2^33), where `map_seed` selects one camera, i.e. one set
/// of mismatched pixels.
[[nodiscard]] PixelThresholds draw_thresholds(const capture::PixelConstants& constants, uint64_t map_seed,
                                              uint64_t pixel);

}  // namespace e2lf::sensor
