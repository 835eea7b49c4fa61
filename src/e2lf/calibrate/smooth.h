// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace e2lf::calibrate {

/// An image with one float per pixel, row-major.
struct Plane {
  size_t height = 0, width = 0;
  std::vector<float> values;

  Plane() = default;
  Plane(size_t height_, size_t width_) : height(height_), width(width_), values(height_ * width_) {}
};

/// Returns the plane blurred by a Gaussian of `sigma_px`, truncated at four sigma. The plane is mirrored at its edges.
[[nodiscard]] Plane blurred(const Plane& plane, double sigma_px);

/// Returns the squared length of the gradient by central differences; it is 0 at the edges.
[[nodiscard]] Plane squared_gradient(const Plane& plane);

}  // namespace e2lf::calibrate
