// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {

/// Lines of a recording's header, key and value.
using HeaderLines = std::vector<std::pair<std::string, std::string>>;

/// The patterns as header lines "e2lf_pattern_1 00000000/00111000/...", one each, counted from 1: rows parted by "/",
/// of digits 0 and 1 where the row has no other values, otherwise of numbers parted by ",".
[[nodiscard]] HeaderLines codes_to_header(const Codes& codes);

/// The patterns that a header holds, in any order and among other lines; nothing when it holds none. Fails with kFormat
/// (a pattern is missing, a row is none) and as codes_from_json() does.
[[nodiscard]] Result<std::optional<Codes>> codes_from_header(const HeaderLines& header, const std::string& location);

}  // namespace e2lf::capture
