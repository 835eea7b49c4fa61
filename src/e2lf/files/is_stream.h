// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"

namespace e2lf {

/// Returns true if `path` is a device, a named pipe or a socket: bytes written there leave in order and cannot be taken
/// back.
[[nodiscard]] bool is_stream(const std::filesystem::path& path);

/// Opens a stream for writing and returns its descriptor. For a named pipe, this waits for a reader. Fails with kIo,
/// and with kCancelled if a stop is requested meanwhile.
[[nodiscard]] Result<int> open_stream(const std::filesystem::path& path);

}  // namespace e2lf
