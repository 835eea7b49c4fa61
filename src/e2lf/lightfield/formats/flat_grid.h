// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::lightfield {

/// The grid of views that are numbered consecutively: number = first + columns * row + column.
struct FlatGrid {
  size_t first = 0, columns = 1;
  size_t rows = 0;  ///< 0 = as many as the numbers reach
};

/// Finds the grid of views with these numbers, which must be sorted and distinct, with at least one. The first of these
/// sources that applies determines it: `columns`, unless it is 0; `num_cams_x` and `num_cams_y` in parameters.cfg in
/// the folder, as in the HCI 4D benchmark; a square number of views from the first to the last number, some of which
/// may be missing; rows of numbers with equal gaps between them, such as those of 8x8 views that keep their numbers of
/// a 9x9 grid. Fails with kInvalidValue if none applies, and with kShape if parameters.cfg contradicts the numbers.
[[nodiscard]] Result<FlatGrid> find_flat_grid(const std::vector<size_t>& numbers, size_t columns,
                                              const std::filesystem::path& folder);

}  // namespace e2lf::lightfield
