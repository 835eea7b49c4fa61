// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "e2lf/engine/aligned_buffer.h"

namespace e2lf::engine {

/// Rows by size, handed out last in, first out: the row taken next is the one most likely still in cache.
class RowPool {
 public:
  /// Memory of `bytes`, aligned to a cache line, with whatever it held before.
  [[nodiscard]] std::byte* take(size_t bytes);
  void give_back(std::byte* row, size_t bytes) { free_[bytes].push_back(row); }

  /// Memory of all rows, free or taken.
  [[nodiscard]] size_t bytes() const;

 private:
  std::map<size_t, std::vector<std::byte*>> free_;
  std::vector<AlignedBuffer> slabs_;
};

}  // namespace e2lf::engine
