// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

namespace e2lf {

/// Whether bytes for `path` go out in their order and cannot be taken back: a device, a named pipe or a socket.
[[nodiscard]] bool is_stream(const std::filesystem::path& path);

}  // namespace e2lf
