// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace e2lf {

/// Makes a text safe to print on a terminal: control characters, which could steer the terminal, become "\\x1b" and so
/// on, except for line ends and tabs. Bytes that are not valid UTF-8 are escaped in the same way.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace e2lf
