// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "e2lf/base/rng.h"
#include "e2lf/capture/patterns/codes.h"

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

/// Draws black and `num_lit` lit patterns of 8x8 cells in [0, 1]: compact apertures of any outline, parts of the
/// aperture beside lines, or patterns of one of the `known` sets (which may contain black ones), with the edges,
/// leakage and transmissions of real displays. The centroids of the lit ones differ.
[[nodiscard]] capture::Codes draw_patterns(size_t num_lit, const std::vector<capture::Codes>& known, Draws& draws);

/// Reads the patterns of a model file, a bundled model or a JSON file. (Other formats would need libraries that a
/// machine with only torch may lack.) Fails with kShape unless the file has patterns of 8x8 cells, and as read_model()
/// and codes_from_json() do.
[[nodiscard]] Result<capture::Codes> read_pattern_set(const std::string& name);

}  // namespace e2lf::learn
