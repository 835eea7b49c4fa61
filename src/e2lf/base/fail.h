// SPDX-License-Identifier: MIT
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"

namespace e2lf {

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

}  // namespace e2lf
