// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

namespace e2lf {

/// Philox4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011): four random words from a
/// counter and a key. Stateless, so a draw depends on nothing but its arguments.
[[nodiscard]] std::array<uint32_t, 4> philox4x32(std::array<uint32_t, 4> counter, std::array<uint32_t, 2> key);

/// Draws that depend only on (seed, stream, index): a simulation is the same for any number of threads and any order.
/// Key = seed; counter = {index low, index high, stream low, stream high}.
class CounterRng {
 public:
  CounterRng(uint64_t seed, uint64_t stream) : seed_(seed), stream_(stream) {}

  /// Four independent uniform words for this index.
  [[nodiscard]] std::array<uint32_t, 4> bits(uint64_t index) const;

  /// Uniform in [0, 1), 24 bits, from the first word of bits(index).
  [[nodiscard]] float uniform(uint64_t index) const;

  /// Two independent standard normal draws by Box-Muller from the first two words of bits(index), in float32:
  /// r = sqrt(-2 ln(u0)), u0 = (word0 + 0.5) / 2^32 rounded to float32; angle = 2 pi word1 / 2^32; {r cos, r sin}.
  [[nodiscard]] std::array<float, 2> normal2(uint64_t index) const;

  /// Uniform integer in [0, bound), bound >= 1, by multiply-shift from the first word (bias below bound / 2^32).
  [[nodiscard]] uint32_t below(uint64_t index, uint32_t bound) const;

 private:
  uint64_t seed_;
  uint64_t stream_;
};

}  // namespace e2lf
