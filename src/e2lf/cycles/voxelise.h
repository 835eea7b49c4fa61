// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/measurement/voxel_grid.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// Spreads events over the bins of a grid, as E2VID does (Rebecq et al., TPAMI 2021, Eq. 1; EVREAL): an event with sign
/// p (+1 ON, -1 OFF) at time t adds p max(0, 1 - |t* - b|) to bin b of its pixel, t* = (t - t_first) / (t_last -
/// t_first) (bins - 1). Where all events are of one time, they are spread evenly over the bins in their order. The
/// events are sorted by time and inside of the image; others break the contract.
[[nodiscard]] capture::VoxelGrid voxelise(const recordings::EventColumns& events, size_t bins, size_t height,
                                          size_t width);

/// The sum of the signed events of each pixel, [y, x]: the grid with one bin.
[[nodiscard]] std::vector<float> signed_counts(const recordings::EventColumns& events, size_t height, size_t width);

}  // namespace e2lf::cycles
