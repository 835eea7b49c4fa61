// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {

/// Lines of a recording's header, each a key and its value.
using HeaderLines = std::vector<std::pair<std::string, std::string>>;

/// Formats the patterns as header lines "e2lf_pattern_1 00000000/00111000/...", one per pattern, numbered from 1. Rows
/// are separated by "/". A row of a binary pattern consists of digits 0 and 1, a row of any other pattern of numbers
/// separated by ",".
[[nodiscard]] HeaderLines codes_to_header(const Codes& codes);

/// Reads the patterns from the lines of a header, which may be in any order and among other lines. Returns nothing if
/// there are none. Fails with kFormat (a missing pattern, or a malformed row) and as codes_from_json() does.
[[nodiscard]] Result<std::optional<Codes>> codes_from_header(const HeaderLines& header, const std::string& location);

}  // namespace e2lf::capture
