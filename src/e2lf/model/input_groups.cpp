// SPDX-License-Identifier: MIT
// What the groups of input channels say of a model; declared in model.h.
#include <algorithm>

#include "e2lf/model/model.h"

namespace e2lf::model {

size_t num_input_channels(InputKind kind, size_t num_patterns) {
  switch (kind) {
    case InputKind::kCounts:
    case InputKind::kCumulative:
    case InputKind::kLevel:
    case InputKind::kIntensity:
      return num_patterns - 1;
    case InputKind::kCamera:
      return capture::conditioning_size(num_patterns);
    case InputKind::kImages:
      return num_patterns;
    case InputKind::kImageSum:
      return 1;
    case InputKind::kLensArray:
      return capture::kLensPixels * capture::kLensPixels;
    case InputKind::kCentral:
      return kCentralPlanes;
  }
  return 0;
}

size_t num_input_channels(const std::vector<InputGroup>& groups, size_t num_patterns) {
  size_t channels = 0;
  for (const InputGroup& group : groups) channels += num_input_channels(group.kind, num_patterns);
  return channels;
}

Result<capture::MeasurementKind> measurement_of(const std::vector<InputGroup>& groups) {
  const auto has = [&](InputKind kind) {
    return std::any_of(groups.begin(), groups.end(), [kind](const InputGroup& group) { return group.kind == kind; });
  };
  const bool has_events = std::any_of(groups.begin(), groups.end(), [](const InputGroup& group) {
    return is_of_counts(group) || group.kind == InputKind::kCamera;
  });
  const bool has_images = has(InputKind::kImages), has_sum = has(InputKind::kImageSum),
             has_lenses = has(InputKind::kLensArray);
  using capture::MeasurementKind;
  if (!has_images && !has_lenses) return has_sum ? MeasurementKind::kHybrid : MeasurementKind::kEventImages;
  if (has_images && !has_events && !has_sum && !has_lenses) return MeasurementKind::kCodedImages;
  if (has_lenses && !has_events && !has_sum && !has_images) return MeasurementKind::kLensArray;
  return fail(ErrorCode::kInvalidValue, "input",
              "no measurement provides all of these inputs; use only images, only lens-array, or only inputs from "
              "events with or without "
              "image-sum");
}

bool is_conditioned_on_camera(const Model& model) {
  return std::any_of(model.input.begin(), model.input.end(), [](const InputGroup& group) {
    return group.kind == InputKind::kCamera || group.kind == InputKind::kCentral;
  });
}

bool is_picture_network(const Model& model) {
  return model.input.size() == 1 && model.input[0].kind == InputKind::kCentral;
}

}  // namespace e2lf::model
