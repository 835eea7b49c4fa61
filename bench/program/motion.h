// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// Implements e2lf-bench motion, which compares the whole cycle with the lit transitions while the scene moves.
int run_motion(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
