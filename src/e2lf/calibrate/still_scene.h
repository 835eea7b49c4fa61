// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::calibrate {

/// An image [y, x] with one float per pixel.
using Plane = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the plane blurred by a Gaussian of `sigma_px`, truncated at four sigma. The plane is mirrored at its edges.
[[nodiscard]] Plane blurred(const Plane& plane, double sigma_px);

/// Returns the squared length of the gradient by central differences; it is 0 at the edges.
[[nodiscard]] Plane squared_gradient(const Plane& plane);

/// The cycles of one static scene.
struct StillScene {
  std::vector<capture::EventImages> cycles;
};

enum class PixelState : uint8_t {
  kGood = 0,
  kHot = 1,   ///< its counts are far outside of the range of its neighbours
  kDead = 2,  ///< it has no events although all its neighbours have some
};

/// Classifies each pixel over all scenes. The counts of a hot pixel are outside of the range of its 24 neighbours by
/// three events in a single cycle, or by one event per cycle over nine or more cycles. A dead pixel has no events
/// although its neighbours have two per cycle; it is not found if all scenes are too dark for that.
[[nodiscard]] std::vector<PixelState> find_bad_pixels(const std::vector<StillScene>& scenes);

/// Checks that there is a scene, that each has a cycle, and that all have the same shape, with at least one transition
/// and 64x64 px. Fails with kShape.
[[nodiscard]] Result<void> check_scenes(const std::vector<StillScene>& scenes);

/// Returns the mean counts of each transition, one plane each. Bad pixels get the median of their good neighbours.
[[nodiscard]] std::vector<Plane> mean_counts(const StillScene& scene, const std::vector<PixelState>& states);

}  // namespace e2lf::calibrate
