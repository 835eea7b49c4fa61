// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// e2lf-bench depth: the errors of disparity maps, and whether occlusions tell the order of the views.
int run_depth(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
