// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Comma-separated values (RFC 4180).
namespace e2lf {

/// Returns a cell as it is written: quoted if it contains a comma, a quote or a line break.
[[nodiscard]] std::string csv_cell(const std::string& text);

/// Returns the cells of a line without its line break.
[[nodiscard]] std::vector<std::string> csv_cells(std::string_view line);

}  // namespace e2lf
