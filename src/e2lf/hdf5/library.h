// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <hdf5.h>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"

/// The HDF5 library, made safe for files from anywhere: one lock, handles that close themselves, and guards against
/// what a damaged or hostile file claims (storage.h). For recordings and light fields alike.
namespace e2lf::hdf5 {

/// The HDF5 library is not thread-safe: every use of it holds this lock. While it is held the library does not print
/// its errors; what was set before is restored at the end.
class LibraryLock {
 public:
  LibraryLock();
  LibraryLock(const LibraryLock&) = delete;
  LibraryLock& operator=(const LibraryLock&) = delete;
  ~LibraryLock();

 private:
  std::lock_guard<std::recursive_mutex> guard_;
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// An HDF5 identifier that is closed with the object; invalid when negative.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      close();
      id_ = std::exchange(other.id_, -1);
      close_ = other.close_;
    }
    return *this;
  }
  ~Handle() { close(); }

  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] bool valid() const { return id_ >= 0; }

  /// False when the library could not close it (for a file: not write it).
  bool close();

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Opens a file, or the bytes of one, for reading, so that nothing beyond its end is read (bytes_driver.h); invalid
/// when the library refuses.
[[nodiscard]] Handle open_file(const std::filesystem::path& path);
[[nodiscard]] Handle open_bytes(std::vector<uint8_t> bytes);

/// What HDF5 says was the root of its last error, e.g. "truncated file".
[[nodiscard]] std::string last_reason();

}  // namespace e2lf::hdf5
