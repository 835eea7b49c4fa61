// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace e2lf {

/// A text for a terminal: control characters, which steer it, become "\\x1b" and the like; ends of lines and tabs stay.
/// Bytes that are no UTF-8 are treated alike.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace e2lf
