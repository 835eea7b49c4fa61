// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace e2lf::report {

/// Escapes a text for HTML and XML, for use in elements and in quoted attributes: `& < > " '` become entities. Bytes
/// that are not valid UTF-8, which names of files may contain, and characters that XML forbids become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// Escapes a text for LaTeX: special characters are escaped, and line ends and tabs become spaces. Invalid bytes are
/// replaced as in escaped().
[[nodiscard]] std::string latex_escaped(std::string_view text);

/// Returns the number of characters in a UTF-8 text, i.e. of the bytes that are not continuation bytes.
[[nodiscard]] size_t num_characters(std::string_view text);

/// Encodes bytes in Base64 (RFC 4648), padded with "=".
[[nodiscard]] std::string base64(std::span<const uint8_t> bytes);

}  // namespace e2lf::report
