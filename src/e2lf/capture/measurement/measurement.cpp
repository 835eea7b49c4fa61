// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/measurement.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "e2lf/base/text.h"

namespace e2lf::capture {
namespace {

constexpr const char* kNames[] = {"event-images", "coded-images", "hybrid", "lens-array"};

}  // namespace

const char* measurement_name(MeasurementKind kind) {
  return kNames[static_cast<size_t>(kind)];
}

Result<MeasurementKind> measurement_from_name(const std::string& name) {
  const auto* const found = std::find(std::begin(kNames), std::end(kNames), name);
  if (found != std::end(kNames)) return static_cast<MeasurementKind>(found - std::begin(kNames));
  return fail(ErrorCode::kInvalidValue, "", "the measurement \"", name, "\" is not known; use ",
              join({std::begin(kNames), std::end(kNames)}));
}

bool has_events(MeasurementKind kind) {
  return kind == MeasurementKind::kEventImages || kind == MeasurementKind::kHybrid;
}

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
