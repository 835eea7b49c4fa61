// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/hdf5/library.h"

namespace e2lf::hdf5 {

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

}  // namespace e2lf::hdf5
