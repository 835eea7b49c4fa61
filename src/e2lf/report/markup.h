// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace e2lf::report {

/// A text for HTML and XML, in elements and in quoted attributes: `& < > " '` become entities. Bytes that are no UTF-8,
/// as names of files may hold, and characters that XML forbids become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// A text for LaTeX: what has a meaning there is escaped, line ends become spaces. Bytes as in escaped().
[[nodiscard]] std::string latex_escaped(std::string_view text);

/// How many characters a text in UTF-8 has: bytes that do not continue one.
[[nodiscard]] size_t num_characters(std::string_view text);

}  // namespace e2lf::report
