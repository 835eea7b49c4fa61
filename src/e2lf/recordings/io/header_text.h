// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace e2lf::recordings {

/// Returns whether the bytes are UTF-8, as headers should be.
[[nodiscard]] bool is_utf8(std::string_view bytes);

/// Returns the value of a header key as one line of UTF-8: bytes that are not UTF-8 are read as Latin-1, and control
/// characters become spaces.
[[nodiscard]] std::string header_text(std::string_view bytes);

}  // namespace e2lf::recordings
