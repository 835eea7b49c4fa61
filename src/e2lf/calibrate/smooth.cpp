// SPDX-License-Identifier: MIT
#include "e2lf/calibrate/smooth.h"

#include <cmath>

#include "e2lf/base/threads.h"

namespace e2lf::calibrate {
namespace {

std::vector<float> gaussian_kernel(double sigma_px) {
  const auto radius = static_cast<size_t>(std::ceil(4.0 * sigma_px));
  std::vector<float> kernel(2 * radius + 1);
  double sum = 0.0;
  for (size_t i = 0; i < kernel.size(); ++i) {
    const double distance = (static_cast<double>(i) - static_cast<double>(radius)) / sigma_px;
    kernel[i] = static_cast<float>(std::exp(-0.5 * distance * distance));
    sum += kernel[i];
  }
  for (float& weight : kernel) weight /= static_cast<float>(sum);
  return kernel;
}

/// Returns the mirrored position of a pixel beyond the edges; the edge is repeated, so that -1 becomes 0.
size_t mirrored(ptrdiff_t place, size_t size) {
  const auto period = static_cast<ptrdiff_t>(2 * size);
  ptrdiff_t inside = place % period;
  if (inside < 0) inside += period;
  return static_cast<size_t>(inside < static_cast<ptrdiff_t>(size) ? inside : period - 1 - inside);
}

/// Blurs every row and transposes the plane, so that two calls blur in both directions.
Plane blur_rows_transposed(const Plane& plane, const std::vector<float>& kernel) {
  Plane result(plane.width, plane.height);
  const auto radius = static_cast<ptrdiff_t>(kernel.size() / 2);
  parallel_for(plane.height, 16, [&](size_t begin, size_t end) {
    std::vector<float> row(plane.width + kernel.size());
    for (size_t y = begin; y < end; ++y) {
      const float* source = plane.values.data() + y * plane.width;
      for (size_t i = 0; i < row.size(); ++i)
        row[i] = source[mirrored(static_cast<ptrdiff_t>(i) - radius, plane.width)];
      for (size_t x = 0; x < plane.width; ++x) {
        float sum = 0.0F;
        for (size_t i = 0; i < kernel.size(); ++i) sum += kernel[i] * row[x + i];
        result.values[x * plane.height + y] = sum;
      }
    }
  });
  return result;
}

}  // namespace

Plane blurred(const Plane& plane, double sigma_px) {
  const std::vector<float> kernel = gaussian_kernel(sigma_px);
  return blur_rows_transposed(blur_rows_transposed(plane, kernel), kernel);
}

Plane squared_gradient(const Plane& plane) {
  Plane result(plane.height, plane.width);
  for (size_t y = 1; y + 1 < plane.height; ++y) {
    for (size_t x = 1; x + 1 < plane.width; ++x) {
      const size_t p = y * plane.width + x;
      const float along_x = 0.5F * (plane.values[p + 1] - plane.values[p - 1]);
      const float along_y = 0.5F * (plane.values[p + plane.width] - plane.values[p - plane.width]);
      result.values[p] = along_x * along_x + along_y * along_y;
    }
  }
  return result;
}

}  // namespace e2lf::calibrate
