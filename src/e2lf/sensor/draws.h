// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "e2lf/base/rng.h"

namespace e2lf::sensor {

/// The streams of the generator for constant properties of a pixel.
inline constexpr uint64_t kThresholdStream = uint64_t{1} << 33;
inline constexpr uint64_t kHotStream = kThresholdStream + 1;
/// The streams for varying quantities. The number of the pattern or segment is added.
inline constexpr uint64_t kDefectStream = uint64_t{1} << 34;
inline constexpr uint64_t kSegmentStream = uint64_t{1} << 35;
inline constexpr uint64_t kImageStream = uint64_t{1} << 36;

/// Converts a word to a uniform number in (0, 1) with 24 bits.
inline float uniform_of(uint32_t word) {
  return (static_cast<float>(word >> 8) + 0.5F) * 0x1p-24F;
}

/// Returns two independent standard normal draws made from two words.
inline std::array<float, 2> normals_of(uint32_t word0, uint32_t word1) {
  const float radius = std::sqrt(-2.0F * std::log(uniform_of(word0)));
  const float angle = uniform_of(word1) * (2.0F * std::numbers::pi_v<float>);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace e2lf::sensor
