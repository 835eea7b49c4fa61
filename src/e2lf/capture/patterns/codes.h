// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::capture {

/// Aperture patterns in the order they are shown: float32 [N, view_y, view_x], row-major, transmittances in [0, 1].
struct Codes {
  size_t num_patterns = 0, views_y = 0, views_x = 0;
  std::vector<float> values;

  Codes() = default;
  Codes(size_t num_patterns_, size_t views_y_, size_t views_x_)
      : num_patterns(num_patterns_),
        views_y(views_y_),
        views_x(views_x_),
        values(num_patterns_ * views_y_ * views_x_) {}

  [[nodiscard]] size_t pattern_size() const { return views_y * views_x; }
  [[nodiscard]] std::span<float> pattern(size_t n) {
    return std::span(values).subspan(n * pattern_size(), pattern_size());
  }
  [[nodiscard]] std::span<const float> pattern(size_t n) const {
    return std::span(values).subspan(n * pattern_size(), pattern_size());
  }
  bool operator==(const Codes&) const = default;
};

/// Success when there is at least one pattern and every transmittance is in [0, 1]. Fails with kShape (no patterns, or
/// `values` of another size) and kInvalidValue (NaN, out of range), naming pattern and cell; `location` is the file.
[[nodiscard]] Result<void> validate(const Codes& codes, const std::string& location);

/// The first pattern lets no light through, so that the first events measure absolute intensity.
[[nodiscard]] bool is_black_first(const Codes& codes);

/// Every transmittance is 0 or 1, as an aperture with shutters needs.
[[nodiscard]] bool is_binary(const Codes& codes);

/// The mean transmittance of each pattern, in [0, 1]: the share of the open aperture's light that reaches the sensor.
[[nodiscard]] std::vector<float> light_efficiency(const Codes& codes);

/// 1 - transmittance: a pattern and its complement add up to the open aperture.
[[nodiscard]] Codes complement(const Codes& codes);

/// Pattern n of the result is pattern order[n]. `order` holds each of 0 .. N - 1 once; else the contract is broken.
[[nodiscard]] Codes permuted(const Codes& codes, std::span<const size_t> order);

/// Four binary black-first patterns of 8x8 for demos and tests: black, then a round blob of 12 cells in the lower left,
/// lower right and upper right quarter. Equal blobs let just parallax change between them, along x in one transition
/// and along y in the next, over a base line of four views; compact ones keep each coded image sharp.
[[nodiscard]] Codes default_codes();

}  // namespace e2lf::capture
