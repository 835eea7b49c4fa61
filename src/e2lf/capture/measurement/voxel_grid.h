// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace e2lf::capture {

/// The events of a time window, distributed over a few points in time: float32 [bin, y, x], row-major. It is the input
/// of networks that reconstruct frames (Zhu et al., CVPR 2019; Rebecq et al., TPAMI 2021). cycles/voxelise.h computes
/// it.
struct VoxelGrid {
  size_t bins = 0, height = 0, width = 0;
  std::vector<float> values;

  VoxelGrid() = default;
  VoxelGrid(size_t bins_, size_t height_, size_t width_)
      : bins(bins_), height(height_), width(width_), values(bins_ * height_ * width_) {}
  bool operator==(const VoxelGrid&) const = default;
};

/// Normalises the non-zero voxels to mean 0 and standard deviation 1, v <- (v - mean) / max(deviation, 1e-6), with the
/// mean and deviation of these voxels; the others remain zero.
void normalise_nonzero(std::span<float> voxels);

}  // namespace e2lf::capture
