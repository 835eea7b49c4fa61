// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "e2lf/engine/aligned_buffer.h"

namespace e2lf::engine {

/// Returns the distance between rows of this size at which they do not compete for the same cache sets, as they would
/// at a multiple of a page.
[[nodiscard]] size_t spread_stride(size_t row_bytes);

/// A pool of rows by size. Rows are reused last in, first out, because such a row is most likely still in the cache.
class RowPool {
 public:
  /// Returns `bytes` bytes of memory aligned to a cache line, with undefined content.
  [[nodiscard]] std::byte* take(size_t bytes);
  void give_back(std::byte* row, size_t bytes) { free_[bytes].push_back(row); }

  /// Returns the total memory of all rows, free or in use.
  [[nodiscard]] size_t bytes() const;

 private:
  std::map<size_t, std::vector<std::byte*>> free_;
  std::vector<AlignedBuffer> slabs_;
};

}  // namespace e2lf::engine
