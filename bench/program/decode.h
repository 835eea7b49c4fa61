// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// Implements e2lf-bench decode. Returns the exit code of the process.
int run_decode(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
