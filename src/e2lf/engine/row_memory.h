// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

namespace e2lf::engine {

constexpr size_t kCacheLine = 64;

/// Zero-initialised memory that is aligned to a cache line, or to a huge page if it is large, which causes fewer TLB
/// misses.
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  explicit AlignedBuffer(size_t bytes);

  [[nodiscard]] std::byte* data() const { return data_.get(); }
  [[nodiscard]] size_t size() const { return size_; }

  template <typename T>
  [[nodiscard]] T* as() const {
    return reinterpret_cast<T*>(data_.get());
  }

 private:
  struct Free {
    void operator()(std::byte* data) const;
  };
  std::unique_ptr<std::byte, Free> data_;
  size_t size_ = 0;
};

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

/// A tensor of a whole image, stored row by row with the zeros beside each row that kernels read.
struct WholeTensor {
  AlignedBuffer memory;
  size_t row_stride = 0;  ///< in bytes

  [[nodiscard]] std::byte* row(size_t y) const { return memory.data() + y * row_stride; }
};

/// The memory of a recurrent network of the previous frames, which Engine::run_frame() fills. It is initially empty,
/// which means at rest. It belongs to one engine and one image size; using it with another breaks the contract. For
/// networks without memory, it contains working memory that consecutive runs of any engine reuse.
struct FrameState {
  std::vector<WholeTensor> before, now;  ///< one per state
  size_t height = 0, width = 0;          ///< size of the image
  RowPool rows;                        ///< rows of all other tensors; kept, because new memory would have to be cleared
  std::vector<AlignedBuffer> scratch;  ///< one buffer for each thread, kept for the same reason

  void end_frame() { before.swap(now); }
};

}  // namespace e2lf::engine
