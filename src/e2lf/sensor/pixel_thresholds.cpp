// SPDX-License-Identifier: MIT
#include "e2lf/sensor/pixel_thresholds.h"

#include <algorithm>

#include "e2lf/sensor/draws.h"

namespace e2lf::sensor {
namespace {

using enum capture::PixelConstant;
constexpr float kLeastThreshold = 0.3F;  // lower limit, relative to the mean threshold

}  // namespace

PixelThresholds draw_thresholds(const capture::PixelConstants& constants, uint64_t map_seed, uint64_t pixel) {
  const auto words = CounterRng(map_seed, kThresholdStream).bits(pixel);
  const auto [both, on] = normals_of(words[0], words[1]);
  const float off = normals_of(words[2], words[3])[0];
  const auto factor = [&, both = both](float own) {
    return std::max(1.0F + constants[kMismatch] * both + constants[kMismatchEach] * own, kLeastThreshold);
  };
  return {constants[kThresholdOn] * factor(on), constants[kThresholdOff] * factor(off)};
}

}  // namespace e2lf::sensor
