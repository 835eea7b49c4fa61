// SPDX-License-Identifier: MIT
#include "e2lf/engine/row_pool.h"

#include <algorithm>
#include <numeric>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {
namespace {

constexpr size_t kSlabBytes = size_t{2} << 20;

// Rows whose distance is a multiple of a page would compete for the same cache sets.
constexpr size_t kPage = 4096;
constexpr size_t kCacheLine = 64;

}  // namespace

std::byte* RowPool::take(size_t bytes) {
  std::vector<std::byte*>& rows = free_[bytes];
  if (rows.empty()) {
    const size_t stride = round_up(bytes, kPage) + kCacheLine;
    const size_t count = std::max<size_t>(1, kSlabBytes / stride);
    slabs_.emplace_back(std::max(count * stride, kSlabBytes));  // whole huge pages
    for (size_t i = count; i-- > 0;) rows.push_back(slabs_.back().data() + i * stride);
  }
  std::byte* row = rows.back();
  rows.pop_back();
  return row;
}

size_t RowPool::bytes() const {
  return std::accumulate(slabs_.begin(), slabs_.end(), size_t{0},
                         [](size_t sum, const AlignedBuffer& slab) { return sum + slab.size(); });
}

}  // namespace e2lf::engine
