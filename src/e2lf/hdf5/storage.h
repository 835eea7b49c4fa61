// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/hdf5/library.h"

namespace e2lf::hdf5 {

/// Largest chunk that is read, in bytes after unpacking: the library allocates one on the word of the header.
inline constexpr uint64_t kMaxChunkBytes = uint64_t{1} << 27;

/// Largest element that is read, in bytes: the library converts one at a time, in memory of its size.
inline constexpr size_t kMaxElementBytes = size_t{1} << 16;

/// How a data set is stored, and what of its size may be believed.
struct Storage {
  std::vector<hsize_t> extents;  ///< as the header claims
  std::vector<hsize_t> chunk;    ///< extents of a chunk; empty = not chunked
  size_t bytes_each = 0;         ///< per element, in the file
  std::vector<H5Z_filter_t> filters;
  uint64_t chunk_bytes = 0;      ///< after unpacking
  uint64_t stored_bytes = 0;     ///< in the file, packed; no more than the file has
  uint64_t stored_elements = 0;  ///< no more than these can be in the file: what may be allocated

  /// The product of the extents; the largest number when it overflows.
  [[nodiscard]] uint64_t claimed_elements() const;
  [[nodiscard]] bool is_chunked() const { return !chunk.empty(); }
};

/// Looks at a data set that was just opened, without reading or allocating on its word. `location` names it in errors.
/// Fails with kFormat (not readable, or elements inside the header that are not all there: the library would read
/// beyond them), kUnsupported (elements of variable length or above kMaxElementBytes, elements in other files than this
/// one, chunks above kMaxChunkBytes).
[[nodiscard]] Result<Storage> inspect_storage(hid_t dataset, const std::string& location);

/// Fails with kMissingDependency where the library lacks a filter that packed the data set: names it, and the Debian
/// package that brings it.
[[nodiscard]] Result<void> check_filters(const Storage& storage, const std::string& location);

/// Whether a chunk holds as many bytes as the layout says: HDF5 1.10 reads beyond it where it does not. `offset` is the
/// chunk's first element on every axis. Chunks that deflate packs last are inflated for this; of other filters nothing
/// is known, and what the file stores is believed.
[[nodiscard]] bool chunk_is_whole(hid_t dataset, const Storage& storage, const hsize_t* offset);

/// The same for all chunks that the file stores.
[[nodiscard]] bool chunks_are_whole(hid_t dataset, const Storage& storage);

}  // namespace e2lf::hdf5
