// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::lightfield {

/// Where views that are numbered one by one stand: number = first + columns * row + column.
struct FlatGrid {
  size_t first = 0, columns = 1;
  size_t rows = 0;  ///< 0 = as many as the numbers reach
};

/// Finds the grid of the views with these numbers, which are sorted, differ, and are not none. It follows from the
/// first that tells: `columns` where it is not 0; `num_cams_x` and `num_cams_y` in the folder's parameters.cfg, as the
/// HCI 4D benchmark has it; numbers from first to last that are as many as a square has views, some of which may be
/// missing; rows of numbers with equal gaps between them, as of 8x8 views that keep their numbers of 9x9. Fails with
/// kInvalidValue where nothing tells.
[[nodiscard]] Result<FlatGrid> find_flat_grid(const std::vector<size_t>& numbers, size_t columns,
                                              const std::filesystem::path& folder);

}  // namespace e2lf::lightfield
