// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/calibrate/smooth.h"
#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::calibrate {

/// The cycles of one scene that stood still.
struct StillScene {
  std::vector<capture::EventImages> cycles;
};

enum class PixelState : uint8_t {
  kGood = 0,
  kHot = 1,   ///< its counts leave the range of its neighbours by far
  kDead = 2,  ///< no event where all its neighbours have some
};

/// The state of each pixel over all scenes. A hot pixel is outside of what its 24 neighbours count, by three events
/// in a single cycle, or by one a cycle over nine and more. A dead one had no event at all, while its neighbours had
/// two a cycle. Where it was too dark for that in every scene, a dead pixel is not found.
[[nodiscard]] std::vector<PixelState> find_bad_pixels(const std::vector<StillScene>& scenes);

/// Success when there is a scene, each has a cycle, and all have one shape of 1 to kMostTransitions transitions and
/// at least 64x64 px. Fails with kShape.
[[nodiscard]] Result<void> check_scenes(const std::vector<StillScene>& scenes);

/// The mean counts of each transition, one plane each; bad pixels take the median of their good neighbours.
[[nodiscard]] std::vector<Plane> mean_counts(const StillScene& scene, const std::vector<PixelState>& states);

}  // namespace e2lf::calibrate
