// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/files/options.h"

namespace e2lf {

/// The text of a JSON value: indented and ending in a new line, or on one line without any. Never throws: bytes that
/// are no UTF-8, as names of files may hold, become U+FFFD.
[[nodiscard]] std::string json_text(const Json& json);
[[nodiscard]] std::string json_line(const Json& json);

}  // namespace e2lf
