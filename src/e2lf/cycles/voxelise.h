// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/measurement/voxel_grid.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// Distributes events over the bins of a voxel grid as in E2VID (Rebecq et al., TPAMI 2021, Eq. 1) and EVREAL: an event
/// of sign p (+1 ON, -1 OFF) at time t adds p max(0, 1 - |t* - b|) to bin b of its pixel, where t* = (t - t_first) /
/// (t_last - t_first) (bins - 1). If all events have the same time, they are distributed evenly over the bins in their
/// order. The events must be sorted by time and lie within the image, or the contract is broken.
[[nodiscard]] capture::VoxelGrid voxelise(const recordings::EventColumns& events, size_t bins, size_t height,
                                          size_t width);

/// Returns the sum of the signed events of each pixel, [y, x], i.e. the grid with one bin.
[[nodiscard]] std::vector<float> signed_counts(const recordings::EventColumns& events, size_t height, size_t width);

}  // namespace e2lf::cycles
