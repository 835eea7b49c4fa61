// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf {

/// Returns the number of bytes that this process may still allocate: the memory that the system reports as available,
/// or what its address space limit (`ulimit -v`) leaves, whichever is less. Returns the largest number if the system
/// reports neither.
[[nodiscard]] uint64_t available_memory_bytes();

/// Checks that `bytes` bytes of memory are available. Fails with kUnsupported and a message that states both amounts
/// and `remedy`.
[[nodiscard]] Result<void> require_memory(uint64_t bytes, const std::string& remedy, const std::string& location);

}  // namespace e2lf
