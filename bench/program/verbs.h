// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// Implements e2lf-bench camera, which measures the cost of each imperfection of a camera for each model, in dB.
int run_camera(const std::vector<std::string>& arguments);

/// Implements e2lf-bench decode. Returns the exit code of the process.
int run_decode(const std::vector<std::string>& arguments);

/// Implements e2lf-bench depth, which measures the errors of disparity maps, and the order of the views that follows
/// from occlusions.
int run_depth(const std::vector<std::string>& arguments);

/// Implements e2lf-bench motion, which compares the whole cycle with the lit transitions while the scene moves.
int run_motion(const std::vector<std::string>& arguments);

/// Implements e2lf-bench rig, which times each stage of one cycle from light field to light field.
int run_rig(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
