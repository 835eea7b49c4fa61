// SPDX-License-Identifier: MIT
#pragma once

#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace e2lf {

/// Concatenates its arguments as an ostream would print them: cat("view ", 3, " is missing").
template <typename... Args>
[[nodiscard]] std::string cat(const Args&... args) {
  std::ostringstream out;
  (out << ... << args);
  return std::move(out).str();
}

/// Joins the parts with the separator between them: "a, b, c".
[[nodiscard]] std::string join(const std::vector<std::string>& parts, std::string_view separator = ", ");

/// Returns the text with the letters A to Z in lower case, independently of the locale.
[[nodiscard]] std::string lower_case(std::string_view text);

/// Formats a shape as "[3, 720, 1280]".
[[nodiscard]] std::string shape_text(const std::vector<size_t>& shape);

/// Completes an error message about an unknown word. Returns "did you mean "batch"?" if a candidate begins with the
/// word or differs from it by a typing mistake, otherwise "known are batch, steps, rate" (at most twelve), or "there
/// are none" if there are no candidates.
[[nodiscard]] std::string suggestion(std::string_view word, const std::vector<std::string>& candidates,
                                     std::string_view quote = "\"");

}  // namespace e2lf
