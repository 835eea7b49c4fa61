// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/measurement.h"

#include <algorithm>
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
  return Error{ErrorCode::kInvalidValue,
               cat("the measurement \"", name, "\" is not known; use ", join({std::begin(kNames), std::end(kNames)})),
               ""};
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

}  // namespace e2lf::capture
