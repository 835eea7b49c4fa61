// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/cli/declared_verbs.h"

namespace e2lf::cli {

/// The script that completes e2lf's verbs, flags and values in a shell: bash, zsh or fish. Fails with kInvalidValue for
/// another one. The first of the verbs is e2lf itself.
[[nodiscard]] Result<std::string> completion_script(const std::string& shell, const std::vector<DeclaredVerb>& verbs);

}  // namespace e2lf::cli
