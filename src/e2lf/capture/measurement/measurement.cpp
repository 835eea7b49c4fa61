// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/measurement.h"

#include <cmath>

namespace e2lf::capture {

size_t num_images(MeasurementKind kind, size_t num_patterns) {
  switch (kind) {
    case MeasurementKind::kEventImages:
      return 0;
    case MeasurementKind::kCodedImages:
      return num_patterns;
    case MeasurementKind::kHybrid:
    case MeasurementKind::kLensArray:
      return 1;
  }
  return 0;
}

void normalise_nonzero(std::span<float> voxels) {
  double sum = 0.0, squares = 0.0;
  size_t count = 0;
  for (const float value : voxels) {
    if (value == 0.0F) continue;
    sum += value;
    squares += static_cast<double>(value) * value;
    ++count;
  }
  if (count == 0) return;
  constexpr double kLeastDeviation = 1e-6;
  const double mean = sum / static_cast<double>(count);
  const double variance = squares / static_cast<double>(count) - mean * mean;
  const double deviation = std::max(std::sqrt(std::max(variance, 0.0)), kLeastDeviation);
  for (float& value : voxels) {
    if (value != 0.0F) value = static_cast<float>((value - mean) / deviation);
  }
}

}  // namespace e2lf::capture
