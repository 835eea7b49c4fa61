// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/diagnose/finding.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::pipeline {

/// A disparity map that a network of model::is_depth_network() estimates from events.
struct EventDepth {
  depth::DisparityMap
      map;  ///< of view (views_y / 2, views_x / 2) in the order of the patterns, numbered as upright views
  lightfield::Image picture;  ///< the mean intensity through the patterns that the events state, about 0 to 1
};

/// Converts the outputs [1, 2, y, x] of a depth network for the events from which they were computed; the arguments are
/// as below.
[[nodiscard]] Result<EventDepth> depth_of_outputs(const model::Model& model, const lightfield::LightField& outputs,
                                                  const capture::EventImages& events, size_t cycles,
                                                  const capture::Orientation& views);

/// Estimates the disparity of each pixel from the events of one cycle, or from sums over `cycles` of a static scene.
/// `method` was opened with Algorithm::kDepth. `views` is the orientation of the views: turned by 180 degrees, each
/// disparity has the other sign. Fails with kUnsupported if they are flipped along one axis, since no depth fits the
/// events then, and as Reconstructor::reconstruct() does.
[[nodiscard]] Result<EventDepth> depth_of_events(const OpenedMethod& method, const capture::Measurement& measurement,
                                                 size_t cycles = 1, const capture::Orientation& views = {},
                                                 const ProgressFn& progress = {});

/// Returns the finding that true disparities may be larger than those of a map, if 2 % of them or more lie within one
/// step of the first or the last one that the network compares (plane-sweep), or beyond: where the last one is 3.4 px,
/// 3.7 px is found for 4 px. Returns nothing for networks without this operation.
[[nodiscard]] std::optional<diagnose::Finding> range_finding(const model::Model& model, const depth::DisparityMap& map);

/// Returns the finding that less than a tenth of a map has a confidence of at least depth::kLeastConfidence: the light
/// is low, or the events are not of the stated patterns. On the eight scenes by which the
/// limit was chosen, correct rigs have at least 39 % in full light, and at a fifth of it three have less than a tenth.
[[nodiscard]] std::optional<diagnose::Finding> confidence_finding(const depth::DisparityMap& map);

}  // namespace e2lf::pipeline
