// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace e2lf::recordings {

/// Returns bytes as text, and text as bytes.
[[nodiscard]] inline std::string_view as_text(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
[[nodiscard]] inline std::span<const uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

/// Returns a text without blanks at its begin and end.
[[nodiscard]] std::string_view trimmed(std::string_view text, std::string_view blanks = " \t");

/// Returns a text without the byte order mark with which some programs begin UTF-8.
[[nodiscard]] std::string_view without_mark(std::string_view text);

/// Returns whether the bytes are UTF-8, as headers should be.
[[nodiscard]] bool is_utf8(std::string_view bytes);

/// Returns the value of a header key as one line of UTF-8: bytes that are not UTF-8 are read as Latin-1, and control
/// characters become spaces.
[[nodiscard]] std::string header_text(std::string_view bytes);

}  // namespace e2lf::recordings
