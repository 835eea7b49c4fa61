// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace e2lf::capture {

/// The events of a window of time, spread over a few moments: float32 [bin, y, x], row-major. What networks that make
/// frames of events take (Zhu et al., CVPR 2019; Rebecq et al., TPAMI 2021). cycles/voxelise.h fills it.
struct VoxelGrid {
  size_t bins = 0, height = 0, width = 0;
  std::vector<float> values;

  VoxelGrid() = default;
  VoxelGrid(size_t bins_, size_t height_, size_t width_)
      : bins(bins_), height(height_), width(width_), values(bins_ * height_ * width_) {}
  bool operator==(const VoxelGrid&) const = default;
};

/// Makes the voxels that are not zero have mean 0 and standard deviation 1: v <- (v - mean) / max(deviation, 1e-6) of
/// these voxels together; the others stay zero.
void normalise_nonzero(std::span<float> voxels);

}  // namespace e2lf::capture
