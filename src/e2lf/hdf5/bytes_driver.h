// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <hdf5.h>
#include <vector>

namespace e2lf::hdf5 {

/// Opens a file, or the bytes of one, through a file driver of our own. Returns a negative number if the library
/// refuses. The library's own drivers answer a read beyond the end with zeros, and they keep buffers of metadata and
/// elements that HDF5 1.10 reads wrongly if a damaged file gives addresses beyond its end, which crashes. Our driver is
/// read-only and has no buffers. It rejects reads that do not lie entirely within the file and object headers by which
/// the library would divide by zero. Links to other files are not followed. The caller must hold the library's lock.
[[nodiscard]] hid_t open_path_to_read(const std::filesystem::path& path);
[[nodiscard]] hid_t open_bytes_to_read(std::vector<uint8_t> bytes);

}  // namespace e2lf::hdf5
