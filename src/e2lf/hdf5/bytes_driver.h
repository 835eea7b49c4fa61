// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <hdf5.h>
#include <vector>

namespace e2lf::hdf5 {

/// Opens a file, or the bytes of one, through a file driver of our own; negative when the library refuses. The
/// library's own drivers answer a read beyond the end with zeros, and keep buffers of metadata and elements that 1.10
/// reads wrongly where a damaged file gives addresses beyond its end: a crash. Ours only reads, refuses what is not
/// whole inside the file, or an object header that it would divide by zero for, and keeps no buffer. Links to other
/// files lead nowhere. The caller holds the library's lock.
[[nodiscard]] hid_t open_path_to_read(const std::filesystem::path& path);
[[nodiscard]] hid_t open_bytes_to_read(std::vector<uint8_t> bytes);

}  // namespace e2lf::hdf5
