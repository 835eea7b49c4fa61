// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/cli/verb.h"

namespace e2lf::cli {

/// Returns a word as a shell requires it: quoted if it contains more than letters, digits and the common characters of
/// paths.
[[nodiscard]] std::string shell_word(const std::string& word);

/// Prints a command that uses the result, "next: e2lf view out", as the last line of a run. Prints nothing with --quiet
/// or --json.
void print_next_step(const std::string& command, const CommonOptions& common);

}  // namespace e2lf::cli
