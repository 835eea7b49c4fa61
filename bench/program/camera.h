// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// Implements e2lf-bench camera, which measures the cost of each imperfection of a camera for each model, in dB.
int run_camera(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
