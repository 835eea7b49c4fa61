// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace e2lf::bench {

/// e2lf-bench motion: what the transitions of a whole cycle gain or lose if the scene moves.
int run_motion(const std::vector<std::string>& arguments);

}  // namespace e2lf::bench
