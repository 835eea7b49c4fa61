// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"

namespace e2lf {

/// Whether bytes for `path` go out in their order and cannot be taken back: a device, a named pipe or a socket.
[[nodiscard]] bool is_stream(const std::filesystem::path& path);

/// A descriptor to write to a stream; of a named pipe it comes when somebody reads there. Fails with kIo, and with
/// kCancelled when a stop is asked for before.
[[nodiscard]] Result<int> open_stream(const std::filesystem::path& path);

}  // namespace e2lf
