// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Disparity maps to look at: one, or one for each cycle, px per view step of the pixels of one view.
struct DisparityMaps {
  std::vector<lightfield::Image> maps;
  depth::ViewIndex view;
};

/// Reads the maps of a light field of that shape with so many cycles: float32 [y, x] as .npy, .pfm, or a folder as
/// `e2lf depth` writes it (disparity.npy, or the same in cycle_00000 ...). The record beside it says which view they
/// are of; without one it is depth::middle_view(). Fails with kNotFound, kFormat, and kShape where size or number do
/// not fit.
[[nodiscard]] Result<DisparityMaps> read_disparity(const std::filesystem::path& path, const lightfield::Shape& shape,
                                                   size_t cycles);

}  // namespace e2lf::cli
