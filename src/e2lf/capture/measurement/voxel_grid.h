// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "e2lf/base/planes.h"

namespace e2lf::capture {

/// The events of a time window, distributed over a few points in time: float32 [bin, y, x], row-major. It is the input
/// of networks that reconstruct frames (Zhu et al., CVPR 2019; Rebecq et al., TPAMI 2021). cycles/event_windows.h
/// computes it.
using VoxelGrid = Planes<float>;

/// Normalises the non-zero voxels to mean 0 and standard deviation 1, v <- (v - mean) / max(deviation, 1e-6), with the
/// mean and deviation of these voxels; the others remain zero.
void normalise_nonzero(std::span<float> voxels);

}  // namespace e2lf::capture
