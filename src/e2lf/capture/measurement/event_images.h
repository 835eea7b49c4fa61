// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace e2lf::capture {

/// The event images of one cycle: int16 [transition, y, x], row-major. Each value is the sum of the signed events (+1
/// ON, -1 OFF) of a pixel during one transition between patterns (Eq. 2). N patterns have N - 1 transitions.
struct EventImages {
  size_t transitions = 0, height = 0, width = 0;
  std::vector<int16_t> counts;

  EventImages() = default;
  EventImages(size_t transitions_, size_t height_, size_t width_)
      : transitions(transitions_), height(height_), width(width_), counts(transitions_ * height_ * width_) {}

  [[nodiscard]] size_t image_size() const { return height * width; }
  [[nodiscard]] std::span<int16_t> image(size_t transition) {
    return std::span(counts).subspan(transition * image_size(), image_size());
  }
  [[nodiscard]] std::span<const int16_t> image(size_t transition) const {
    return std::span(counts).subspan(transition * image_size(), image_size());
  }
  bool operator==(const EventImages&) const = default;
};

}  // namespace e2lf::capture
