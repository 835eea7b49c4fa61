// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/depth/disparity.h"
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
/// `method` was opened with the algorithm "depth". `views` is the orientation of the views: turned by 180 degrees, each
/// disparity has the other sign. Fails with kUnsupported if they are flipped along one axis, since no depth fits the
/// events then, and as Reconstructor::reconstruct() does.
[[nodiscard]] Result<EventDepth> depth_of_events(const OpenedMethod& method, const capture::Measurement& measurement,
                                                 size_t cycles = 1, const capture::Orientation& views = {},
                                                 const ProgressFn& progress = {});

/// Returns the share of the pixels whose disparities lie within one step of the first or the last one that the network
/// compares (plane-sweep), or beyond: the true ones may be larger, and 3.7 px is found where 4 px are true if the last
/// one is 3.4 px. Returns 0 for networks without this operation.
[[nodiscard]] double share_at_end_of_range(const model::Model& model, const depth::DisparityMap& map);

/// From this share on, users should know.
inline constexpr double kMuchAtEndOfRange = 0.02;

}  // namespace e2lf::pipeline
