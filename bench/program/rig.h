// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// Implements e2lf-bench rig, which times each stage of one cycle from light field to light field.
int run_rig(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
