// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf {

/// Bytes that this process may still take: what the system calls available, less where a limit on its address space
/// (`ulimit -v`) is nearer. The largest number where the system does not tell.
[[nodiscard]] uint64_t available_memory_bytes();

/// Success when so many bytes are there. Fails with kUnsupported, naming both amounts and `remedy`.
[[nodiscard]] Result<void> require_memory(uint64_t bytes, const std::string& remedy, const std::string& location);

}  // namespace e2lf
