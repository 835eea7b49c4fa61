// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Disparity maps of one view, px per view step: one, or one for each cycle.
struct DisparityMaps {
  std::vector<lightfield::Image> maps;
  depth::ViewIndex view;
};

/// Reads the disparity maps of a light field with the given shape and number of cycles: float32 [y, x] as .npy or .pfm,
/// or a folder that `e2lf depth` wrote (disparity.npy, or one in each of cycle_00000 ...). The record beside the maps
/// states to which view they belong; without a record it is depth::middle_view(). Fails with kNotFound, kFormat, and
/// kShape (the size or number of the maps does not match).
[[nodiscard]] Result<DisparityMaps> read_disparity(const std::filesystem::path& path, const lightfield::Shape& shape,
                                                   size_t cycles);

}  // namespace e2lf::cli
