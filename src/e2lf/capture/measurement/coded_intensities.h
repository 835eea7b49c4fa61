// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace e2lf::capture {

/// The intensities that the sensor receives under each pattern (Eq. 1), divided by the number of views: float32
/// [pattern, y, x], row-major.
struct CodedIntensities {
  size_t num_patterns = 0, height = 0, width = 0;
  std::vector<float> values;

  CodedIntensities() = default;
  CodedIntensities(size_t num_patterns_, size_t height_, size_t width_)
      : num_patterns(num_patterns_), height(height_), width(width_), values(num_patterns_ * height_ * width_) {}

  [[nodiscard]] size_t image_size() const { return height * width; }
  [[nodiscard]] std::span<float> image(size_t pattern) {
    return std::span(values).subspan(pattern * image_size(), image_size());
  }
  [[nodiscard]] std::span<const float> image(size_t pattern) const {
    return std::span(values).subspan(pattern * image_size(), image_size());
  }
};

}  // namespace e2lf::capture
