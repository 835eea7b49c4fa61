// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/hdf5/library.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::recordings::hdf5_events {

using e2lf::hdf5::Handle;
using e2lf::hdf5::LibraryLock;
using e2lf::hdf5::Storage;

/// Opens the file of a source for reading; a source without a file is read into memory first. Fails with kFormat and
/// kIo.
[[nodiscard]] Result<Handle> open_file(ByteSource& source);

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
/// (other shapes), and as hdf5::inspect_storage() does. `location` names the file and data set in errors.
[[nodiscard]] Result<DatasetShape> open_dataset(hid_t file, const std::string& name, const std::string& location,
                                                uint64_t columns = 1);

/// Reads rows [begin, begin + count) to `out` as `memory_type`. Fails with kIo, and with kTruncated if the file does
/// not contain them.
[[nodiscard]] Result<void> read_elements(const DatasetShape& shape, hid_t memory_type, uint64_t begin, uint64_t count,
                                         void* out, const std::string& location);

}  // namespace e2lf::recordings::hdf5_events
