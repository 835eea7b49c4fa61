// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/files/options.h"

namespace e2lf {

/// Formats a JSON value as text: json_text() indents it and ends it with a new line, json_line() writes one line
/// without a new line. They never throw: bytes that are not valid UTF-8, which names of files may contain, become
/// U+FFFD.
[[nodiscard]] std::string json_text(const Json& json);
[[nodiscard]] std::string json_line(const Json& json);

}  // namespace e2lf
