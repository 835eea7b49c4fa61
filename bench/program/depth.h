// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// Implements e2lf-bench depth, which measures the errors of disparity maps, and the order of the views that follows
/// from occlusions.
int run_depth(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
