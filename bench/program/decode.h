// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// e2lf-bench decode; returns the process's exit code.
int run_decode(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
