// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// e2lf-bench camera: what each imperfection of a camera costs, in dB, for each model.
int run_camera(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
