// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace e2lf::calibrate {

/// One float for each pixel, row-major.
struct Plane {
  size_t height = 0, width = 0;
  std::vector<float> values;

  Plane() = default;
  Plane(size_t height_, size_t width_) : height(height_), width(width_), values(height_ * width_) {}
};

/// The plane blurred by a Gaussian of `sigma_px`, cut off at four sigma. Beyond its edges the plane is mirrored.
[[nodiscard]] Plane blurred(const Plane& plane, double sigma_px);

/// The squared length of the gradient, by differences over two pixels; 0 at the edges.
[[nodiscard]] Plane squared_gradient(const Plane& plane);

}  // namespace e2lf::calibrate
