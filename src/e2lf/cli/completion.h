// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/cli/declared_verbs.h"

namespace e2lf::cli {

/// Returns the script that completes e2lf's verbs, flags and values in a shell: bash, zsh or fish. The first of `verbs`
/// is e2lf itself. Fails with kInvalidValue for any other shell.
[[nodiscard]] Result<std::string> completion_script(const std::string& shell, const std::vector<DeclaredVerb>& verbs);

}  // namespace e2lf::cli
