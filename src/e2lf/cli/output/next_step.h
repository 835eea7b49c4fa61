// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/cli/verb.h"

namespace e2lf::cli {

/// A word as a shell takes it: in quotes where it holds more than letters, digits and the plain signs of paths.
[[nodiscard]] std::string shell_word(const std::string& word);

/// Prints what one may do with the result: "next: e2lf view out", the last line of a run. Prints nothing with --quiet
/// or
/// --json.
void print_next_step(const std::string& command, const CommonOptions& common);

}  // namespace e2lf::cli
