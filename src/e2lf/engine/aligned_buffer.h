// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>

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

}  // namespace e2lf::engine
