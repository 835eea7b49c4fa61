// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <string>

#include "e2lf/cli/verb.h"
#include "e2lf/files/options.h"

namespace e2lf::cli {

/// Formats text as printf does.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// Returns "1 cycle", "2 cycles".
[[nodiscard]] std::string counted(size_t count, const char* what);

/// Prints the result of a run: `json` with --json, or else `text`, unless with --quiet.
void print_result(const CommonOptions& common, const Json& json, const std::string& text, std::FILE* to = stdout);

/// Returns a word as a shell requires it: quoted if it contains more than letters, digits and the common characters of
/// paths.
[[nodiscard]] std::string shell_word(const std::string& word);

/// Prints a command that uses the result, "next: e2lf view out", as the last line of a run. Prints nothing with --quiet
/// or --json.
void print_next_step(const std::string& command, const CommonOptions& common);

}  // namespace e2lf::cli
