// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace e2lf::cli {

/// Makes every option that holds a number refuse what is none: a sign where the number has none, digits beyond its
/// range, NaN and infinity, other than decimal digits. The library behind the options wraps and clips them silently.
void check_numbers(CLI::App& app);

/// Refuses whole numbers outside [least, most], in words.
[[nodiscard]] CLI::Validator whole_number(int64_t least, int64_t most = INT64_MAX);

/// Refuses 0 and what is below.
[[nodiscard]] CLI::Validator positive_number();

}  // namespace e2lf::cli
