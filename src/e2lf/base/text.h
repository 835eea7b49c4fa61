// SPDX-License-Identifier: MIT
#pragma once

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/result.h"

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

/// Parses the whole text as a number; returns nothing for any other text.
template <typename T>
[[nodiscard]] std::optional<T> parse_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// Returns the text with the letters A to Z in lower case, independently of the locale.
[[nodiscard]] std::string lower_case(std::string_view text);

/// Formats a shape as "[3, 720, 1280]".
[[nodiscard]] std::string shape_text(const std::vector<size_t>& shape);

/// Completes an error message about an unknown word. Returns "did you mean "batch"?" if a candidate begins with the
/// word or differs from it by a typing mistake, otherwise "known are batch, steps, rate" (at most twelve), or "there
/// are none" if there are no candidates.
[[nodiscard]] std::string suggestion(std::string_view word, const std::vector<std::string>& candidates,
                                     std::string_view quote = "\"");

/// Makes a text safe to print on a terminal: control characters, which could steer the terminal, become "\\x1b" and so
/// on, except for line ends and tabs. Bytes that are not valid UTF-8 are escaped in the same way.
[[nodiscard]] std::string printable(std::string_view text);

/// Returns whether the bytes are UTF-8.
[[nodiscard]] bool is_utf8(std::string_view bytes);

/// Returns an error at a location (a path or a text), whose message is the concatenation of `parts`.
template <typename Location, typename... Parts>
[[nodiscard]] Error fail(ErrorCode code, const Location& location, const Parts&... parts) {
  if constexpr (requires { location.string(); }) {
    return {code, cat(parts...), location.string()};
  } else {
    return {code, cat(parts...), location};
  }
}

/// Returns the error of a call of the system that set `error_number`: kNotFound for a file that does not exist,
/// otherwise kIo, with the remedy for this number.
template <typename Location>
[[nodiscard]] Error fail_to(const char* action, const Location& location, int error_number) {
  const char* const remedy = error_number == ENOENT   ? "check the path"
                             : error_number == EACCES ? "check its permissions"
                             : error_number == ENOSPC ? "free some disk space"
                                                      : "check the disk and the path";
  return fail(error_number == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo, location, "cannot ", action, " (",
              std::strerror(error_number), "); ", remedy);
}

/// Formats text as printf does.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// Returns "1 cycle", "2 cycles".
[[nodiscard]] std::string counted(size_t count, const char* what);

/// Returns a cell of comma-separated values (RFC 4180) as it is written: quoted if it contains a comma, a quote or a
/// line break.
[[nodiscard]] std::string csv_cell(const std::string& text);

/// Returns the cells of such a line without its line break.
[[nodiscard]] std::vector<std::string> csv_cells(std::string_view line);

}  // namespace e2lf
