// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// Returns the number of bytes that this process may still allocate: the memory that the system reports as available,
/// or what its address space limit (`ulimit -v`) leaves, whichever is less. Returns the largest number if the system
/// reports neither.
[[nodiscard]] uint64_t available_memory_bytes();

/// Checks that `bytes` bytes of memory are available. Fails with kUnsupported and a message that states both amounts
/// and `remedy`.
[[nodiscard]] Result<void> require_memory(uint64_t bytes, const std::string& remedy, const std::string& location);

/// An allocator that leaves new elements uninitialised, while std::allocator sets them to zero.
template <typename T>
struct UninitialisedAllocator : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = UninitialisedAllocator<U>;
  };
  template <typename U>
  void construct(U* place) noexcept {
    ::new (static_cast<void*>(place)) U;
  }
  template <typename U, typename... Args>
  void construct(U* place, Args&&... args) {
    ::new (static_cast<void*>(place)) U(std::forward<Args>(args)...);
  }
};

/// A std::vector whose resize() leaves the new elements uninitialised, for a caller that then sets all of them.
template <typename T>
using UninitialisedVector = std::vector<T, UninitialisedAllocator<T>>;

}  // namespace e2lf
