// SPDX-License-Identifier: MIT
#include "e2lf/engine/row_pool.h"

#include <algorithm>
#include <numeric>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {
namespace {

constexpr size_t kSlabBytes = size_t{2} << 20;

}  // namespace

size_t spread_stride(size_t row_bytes) {
  constexpr size_t kPage = 4096;
  return round_up(row_bytes, kPage) + kCacheLine;
}

std::byte* RowPool::take(size_t bytes) {
  std::vector<std::byte*>& rows = free_[bytes];
  if (rows.empty()) {
    const size_t stride = spread_stride(bytes);
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
