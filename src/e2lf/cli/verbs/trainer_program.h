// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::cli {

/// Becomes e2lf-train, the program beside this one that holds training: torch is loaded for it alone. `threads` as in
/// CommonOptions. Returns only with kMissingDependency, when it is not there.
[[nodiscard]] Result<void> become_trainer(std::vector<std::string> arguments, int threads);

}  // namespace e2lf::cli
