// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::recon {

/// Above this value of scene_motion(), the lit transitions alone give better light fields than the whole cycle. It
/// corresponds to 3 to 4 px per cycle for the camera evk4-lcos and to 4 to 6 px with the noise of the paper's model.
inline constexpr double kMuchMotion = 0.125;

/// Measures from the 2N event images of a whole cycle (capture::whole_cycle()) how much the scene moved during it. Each
/// pattern and its inverse together open every cell, so that the sum of their two intensities is the same for all
/// patterns if the scene is static. The result is the correlation between neighbouring pixels of the difference of the
/// last two such sums, without its local mean: about 0 if only noise contributes, at most 1, and larger the more the
/// scene moved. The intensities follow from the counts with the threshold of the paper; the value hardly depends on it.
/// If the images are sums over several `cycles`, their means are compared. Returns 0 for fewer than 3 patterns, for an
/// odd number of images, and if the rounding of the counts explains the differences.
[[nodiscard]] double scene_motion(const capture::EventImages& whole_cycle, size_t cycles = 1);

/// Returns the event images of the lit transitions, a1 to a2 to ... aN, from those of a whole cycle.
[[nodiscard]] capture::EventImages lit_transitions(const capture::EventImages& whole_cycle);

}  // namespace e2lf::recon
