// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace e2lf::cli {

/// Makes every option with a numeric value reject malformed numbers: a sign if the type has none, values beyond its
/// range, NaN and infinity, and numbers that are not decimal. CLI11 would wrap or clip them silently.
void check_numbers(CLI::App& app);

/// Returns a validator that rejects integers outside [least, most], with a message in words.
[[nodiscard]] CLI::Validator whole_number(int64_t least, int64_t most = INT64_MAX);

/// Returns a validator that rejects numbers that are not greater than 0.
[[nodiscard]] CLI::Validator positive_number();

}  // namespace e2lf::cli
