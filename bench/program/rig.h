// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// e2lf-bench rig: one cycle from light field to light field, with the time of each stage.
int run_rig(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
