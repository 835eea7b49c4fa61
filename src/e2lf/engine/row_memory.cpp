// SPDX-License-Identifier: MIT
#include "e2lf/engine/row_memory.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <numeric>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {
namespace {

constexpr size_t kHugePage = size_t{2} << 20, kSlabBytes = kHugePage;

}  // namespace

AlignedBuffer::AlignedBuffer(size_t bytes) : size_(bytes) {
  const bool huge = bytes >= kHugePage;
  const size_t allocated = round_up(bytes == 0 ? 1 : bytes, huge ? kHugePage : kCacheLine);
  data_.reset(static_cast<std::byte*>(std::aligned_alloc(huge ? kHugePage : kCacheLine, allocated)));
  if (!data_) throw std::bad_alloc();
#ifdef __linux__
  if (huge) ::madvise(data_.get(), allocated, MADV_HUGEPAGE);
#endif
  std::memset(data_.get(), 0, allocated);
}

void AlignedBuffer::Free::operator()(std::byte* data) const {
  std::free(data);
}

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
