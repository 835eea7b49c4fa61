// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace e2lf {

/// Computes four random words from a counter and a key with Philox4x32-10 (Salmon et al., "Parallel random numbers: as
/// easy as 1, 2, 3", SC 2011). It is stateless, so that a draw depends only on its arguments.
[[nodiscard]] std::array<uint32_t, 4> philox4x32(std::array<uint32_t, 4> counter, std::array<uint32_t, 2> key);

/// Generates draws that depend only on (seed, stream, index), so that a simulation gives the same result for any number
/// of threads and any order. The key is the seed; the counter is {index low, index high, stream low, stream high}.
class CounterRng {
 public:
  CounterRng(uint64_t seed, uint64_t stream) : seed_(seed), stream_(stream) {}

  /// Returns four independent uniform words for this index.
  [[nodiscard]] std::array<uint32_t, 4> bits(uint64_t index) const;

  /// Returns a uniform number in [0, 1) with 24 bits, made from the first word of bits(index).
  [[nodiscard]] float uniform(uint64_t index) const;

  /// Returns two independent standard normal draws, computed in float32 with the Box-Muller transform from the first
  /// two words of bits(index): r = sqrt(-2 ln(u0)), u0 = (word0 + 0.5) / 2^32 rounded to float32, angle = 2 pi word1 /
  /// 2^32; the draws are {r cos(angle), r sin(angle)}.
  [[nodiscard]] std::array<float, 2> normal2(uint64_t index) const;

  /// Returns a uniform integer in [0, bound), where bound >= 1, by multiply-shift of the first word of bits(index). The
  /// bias is below bound / 2^32.
  [[nodiscard]] uint32_t below(uint64_t index, uint32_t bound) const;

 private:
  uint64_t seed_;
  uint64_t stream_;
};

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

}  // namespace e2lf
