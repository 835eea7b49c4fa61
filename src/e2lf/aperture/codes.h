// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/contract.h"

namespace e2lf::aperture {

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

}  // namespace e2lf::aperture
