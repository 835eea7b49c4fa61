// SPDX-License-Identifier: MIT
#include "e2lf/cycles/voxelise.h"

#include <algorithm>

#include "e2lf/base/contract.h"

namespace e2lf::cycles {
namespace {

/// Returns the position of event i among the bins, 0 to bins - 1.
double place_of(const recordings::EventColumns& events, size_t i, size_t bins) {
  const auto last_bin = static_cast<double>(bins - 1);
  const int64_t span_us = events.t.back() - events.t.front();
  if (span_us > 0) return static_cast<double>(events.t[i] - events.t.front()) / static_cast<double>(span_us) * last_bin;
  return events.size() > 1 ? static_cast<double>(i) / static_cast<double>(events.size() - 1) * last_bin : 0.0;
}

}  // namespace

capture::VoxelGrid voxelise(const recordings::EventColumns& events, size_t bins, size_t height, size_t width) {
  E2LF_REQUIRE(bins > 0, "a grid has at least one bin");
  capture::VoxelGrid grid(bins, height, width);
  for (size_t i = 0; i < events.size(); ++i) {
    E2LF_REQUIRE(events.x[i] < width && events.y[i] < height, "an event lies outside of the image");
    const double place = place_of(events, i, bins);
    const size_t bin = std::min(static_cast<size_t>(place), bins - 1);
    const auto share = static_cast<float>(place - static_cast<double>(bin));
    const float sign = events.p[i] != 0 ? 1.0F : -1.0F;
    float* pixel = &grid.values[(bin * height + events.y[i]) * width + events.x[i]];
    *pixel += sign * (1.0F - share);
    if (share > 0.0F) pixel[height * width] += sign * share;
  }
  return grid;
}

std::vector<float> signed_counts(const recordings::EventColumns& events, size_t height, size_t width) {
  return voxelise(events, 1, height, width).values;
}

}  // namespace e2lf::cycles
