// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "e2lf/base/rng.h"

namespace e2lf::learn {

/// Draws scalars one after another from one stream of a counter-based generator.
class Draws {
 public:
  Draws(uint64_t seed, uint64_t stream) : rng_(seed, stream) {}

  [[nodiscard]] double uniform(double low = 0.0, double high = 1.0) {
    return low + (high - low) * rng_.uniform(next_++);
  }
  [[nodiscard]] double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  [[nodiscard]] bool chance(double probability) { return uniform() < probability; }
  [[nodiscard]] uint32_t below(uint64_t bound) { return rng_.below(next_++, static_cast<uint32_t>(bound)); }

 private:
  CounterRng rng_;
  uint64_t next_ = 0;
};

/// Returns a seed for torch's generator that differs for every (seed, purpose, index).
[[nodiscard]] inline uint64_t mix_seed(uint64_t seed, uint64_t purpose, uint64_t index) {
  const auto words = CounterRng(seed, (purpose << 56) ^ index).bits(~uint64_t{0});
  return (uint64_t{words[0]} << 32) | words[1];
}

}  // namespace e2lf::learn
