// SPDX-License-Identifier: MIT
#pragma once

#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace e2lf {

/// Joins its arguments as an ostream would print them: cat("view ", 3, " is missing").
template <typename... Args>
[[nodiscard]] std::string cat(const Args&... args) {
  std::ostringstream out;
  (out << ... << args);
  return std::move(out).str();
}

/// "a, b, c".
[[nodiscard]] std::string join(const std::vector<std::string>& parts, std::string_view separator = ", ");

/// A shape as "[3, 720, 1280]".
[[nodiscard]] std::string shape_text(const std::vector<size_t>& shape);

/// The candidate that begins with `word`, otherwise the one with the smallest edit distance to it; empty when there are
/// no candidates. Used by error messages that name the nearest known key.
[[nodiscard]] std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace e2lf
