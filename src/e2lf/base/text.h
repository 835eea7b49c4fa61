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

/// For error messages about a word that is not known: "did you mean "batch"?" where a candidate begins with the word or
/// is a typing mistake away, else "known are batch, steps, rate" (twelve at most), else "there are none".
[[nodiscard]] std::string suggestion(std::string_view word, const std::vector<std::string>& candidates,
                                     std::string_view quote = "\"");

}  // namespace e2lf
