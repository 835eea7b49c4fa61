// SPDX-License-Identifier: MIT
#include "e2lf/engine/aligned_buffer.h"

#include <cstdlib>
#include <cstring>
#include <new>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {
namespace {

constexpr size_t kHugePage = size_t{2} << 20;

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

}  // namespace e2lf::engine
