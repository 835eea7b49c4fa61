// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::cli {

/// Replaces this process by e2lf-train, the program in the same folder that contains training, so that only it loads
/// torch. `threads` is as in CommonOptions. Returns only if that program is missing, with kMissingDependency.
[[nodiscard]] Result<void> become_trainer(std::vector<std::string> arguments, int threads);

}  // namespace e2lf::cli
