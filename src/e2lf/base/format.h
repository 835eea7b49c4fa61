// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace e2lf {

/// Formats text as printf does.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// Returns "1 cycle", "2 cycles".
[[nodiscard]] std::string counted(size_t count, const char* what);

}  // namespace e2lf
