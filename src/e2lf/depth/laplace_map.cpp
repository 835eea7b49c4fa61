// SPDX-License-Identifier: MIT
#include "e2lf/depth/laplace_map.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/result.h"

namespace e2lf::depth {

DisparityMap map_of_laplace(lightfield::Image location, const lightfield::Image& log_scale, const ViewIndex& view) {
  E2LF_REQUIRE(location.pixels.size() == log_scale.pixels.size() && !location.pixels.empty(), "a scale for each pixel");
  constexpr float kHalfErrorPx = 0.07F, kMostLog = 20.0F;  // beyond this, squares overflow
  DisparityMap map{.disparity = std::move(location), .confidence = log_scale, .view = view, .range = {}};
  for (float& value : map.confidence.pixels) {
    const float ratio = std::exp(std::min(value, kMostLog)) / kHalfErrorPx;
    value = 1 / (1 + ratio * ratio);
  }
  const auto [least, most] = std::minmax_element(map.disparity.pixels.begin(), map.disparity.pixels.end());
  map.range = {*least, *most};
  return map;
}

}  // namespace e2lf::depth
