// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <hdf5.h>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"

/// Wraps the HDF5 library so that files from any source can be opened safely: one lock, handles that close themselves,
/// and guards against the claims of damaged or hostile files (storage.h). It serves recordings and light fields alike.
namespace e2lf::hdf5 {

/// Returns false if a piece of an object header (its beginning or a continuation, of either version) holds a data
/// layout whose chunks have no dimension. One damaged byte of any chunked file does this, as fuzzing found. HDF5 1.10,
/// which Debian 12 has, accepts such a layout and divides by zero in H5Dopen2(), which ends the process. No call of the
/// library shows the layout before, and limits of the process do not help, so this check must stay until 1.10 is gone.
/// Source: HDF5 file format specification, IV.A and IV.A.2.i. All other damage is left to the library.
[[nodiscard]] bool chunks_have_dimensions(std::span<const uint8_t> piece);

/// Locks the HDF5 library, which is not thread-safe; every use of it must hold this lock. While it is held, the library
/// does not print its errors. The previous setting is restored at the end.
class LibraryLock {
 public:
  LibraryLock();
  ~LibraryLock();

 private:
  std::lock_guard<std::recursive_mutex> guard_;
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Owns an HDF5 identifier and closes it. It is invalid if negative.
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

  /// Returns false if the library could not close the identifier, which for a file means that it was not written.
  bool close();

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Opens a file, or the bytes of one, through a file driver of our own. The handle is invalid if the library refuses.
/// The library's own drivers answer a read beyond the end with zeros, and they keep buffers of metadata and elements
/// that HDF5 1.10 reads wrongly if a damaged file gives addresses beyond its end, which crashes. Our driver is
/// read-only and has no buffers. It rejects reads that do not lie entirely within the file and object headers by which
/// the library would divide by zero. Links to other files are not followed.
[[nodiscard]] Handle open_file(const std::filesystem::path& path);
[[nodiscard]] Handle open_bytes(std::vector<uint8_t> bytes);

/// A new HDF5 file whose writes may fail, above all on a full disk. The library cannot handle that: it keeps the data
/// that it could not write and crashes when the process ends. Our driver therefore reports success to the library,
/// keeps the bytes that did not reach the disk, and stores the error for check(). The caller must hold the library's
/// lock.
class CheckedFile {
 public:
  CheckedFile() = default;

  /// Creates the file, or empties an existing one. `name` is the location in errors. Fails with kIo.
  [[nodiscard]] static Result<CheckedFile> create(const std::filesystem::path& path, const std::string& name);

  [[nodiscard]] hid_t get() const { return file_.get(); }

  /// Returns the first write that failed. It must be called after every batch of data, before more are written.
  [[nodiscard]] Result<void> check() const;

  /// Flushes the file to the disk, so that it can be opened even if the run is killed later. Errors are reported by
  /// check().
  void keep_up();
  /// Returns true if keep_up() was never called, or not within the last second.
  [[nodiscard]] bool is_behind() const;

  /// Closes the file, after all of its objects. Fails with kIo if any data did not reach the disk.
  [[nodiscard]] Result<void> close();

 private:
  std::string name_;
  std::shared_ptr<int> error_number_;
  Handle file_;
  std::chrono::steady_clock::time_point kept_up_{};
};

/// Returns the root cause of the last HDF5 error, e.g. "truncated file".
[[nodiscard]] std::string last_reason();

/// The largest chunk that is read, in bytes after unpacking. The library allocates one as the header states.
inline constexpr uint64_t kMaxChunkBytes = uint64_t{1} << 27;

/// The largest element that is read, in bytes. The library converts one element at a time in memory of its size.
inline constexpr size_t kMaxElementBytes = size_t{1} << 16;

/// Describes how a data set is stored and how much of its claimed size can be trusted.
struct Storage {
  std::vector<hsize_t> extents;  ///< as the header claims
  std::vector<hsize_t> chunk;    ///< the extents of a chunk; empty if the data set is not chunked
  size_t bytes_each = 0;         ///< size of an element in the file
  std::vector<H5Z_filter_t> filters;
  uint64_t chunk_bytes = 0;      ///< size of a chunk after unpacking
  uint64_t stored_bytes = 0;     ///< size in the file, compressed; at most the size of the file
  uint64_t stored_elements = 0;  ///< the most elements that the file can hold; limits allocations

  /// Returns the product of the extents, or the largest number if it overflows.
  [[nodiscard]] uint64_t claimed_elements() const;
  [[nodiscard]] bool is_chunked() const { return !chunk.empty(); }
};

/// Inspects a data set that was just opened, without reading its data or allocating memory of its claimed size.
/// `location` names it in errors. Fails with kFormat if it is not readable, or if its elements are stored in the header
/// and are incomplete (the library would read beyond them). Fails with kUnsupported for elements of variable length or
/// above kMaxElementBytes, elements in other files, and chunks above kMaxChunkBytes.
[[nodiscard]] Result<Storage> inspect_storage(hid_t dataset, const std::string& location);

/// Fails with kMissingDependency if the library lacks a filter that compressed the data set. The message names the
/// filter and how to install it.
[[nodiscard]] Result<void> check_filters(const Storage& storage, const std::string& location);

/// Returns true if a chunk holds as many bytes as its layout states; HDF5 1.10 reads beyond the end of one that does
/// not. `offset` is the chunk's first element on every axis. Chunks whose last filter is deflate are inflated for this
/// check. Other filters cannot be checked, and such chunks count as whole.
[[nodiscard]] bool chunk_is_whole(hid_t dataset, const Storage& storage, const hsize_t* offset);

/// Checks all chunks that the file stores in this way.
[[nodiscard]] bool chunks_are_whole(hid_t dataset, const Storage& storage);

/// Returns all text attributes of `object`, by name.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> read_text_attributes(hid_t object);

/// A data set that is open for reading, with one dimension or with rows of several columns, and its plausible length.
struct DatasetShape {
  Handle dataset;
  Storage storage;
  uint64_t columns = 1;         ///< elements per row
  uint64_t length = 0;          ///< number of rows, limited to those that are actually stored
  uint64_t chunk_length = 0;    ///< rows per chunk; 0 = not chunked
  uint64_t claimed_length = 0;  ///< number of rows that the header states, at least `length`
};

/// Opens a data set [rows, columns]; one column may also be a data set with one dimension. Fails with kNotFound, kShape
/// (other shapes), and as inspect_storage() does. `location` names the file and data set in errors.
[[nodiscard]] Result<DatasetShape> open_dataset(hid_t file, const std::string& name, const std::string& location,
                                                uint64_t columns = 1);

/// Reads rows [begin, begin + count) to `out` as `memory_type`. Fails with kIo, and with kTruncated if the file does
/// not contain them.
[[nodiscard]] Result<void> read_elements(const DatasetShape& shape, hid_t memory_type, uint64_t begin, uint64_t count,
                                         void* out, const std::string& location);

}  // namespace e2lf::hdf5
