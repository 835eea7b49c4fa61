// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/recordings/event.h"

namespace e2lf::fuzz {

/// The bytes of a Metavision HDF5 file whose chunks are what `input` says:
///   u8   bits 0-1: chunk length 1, 7, 64 or 16384 events; bit 2: no ECF filter; bit 3: deflate in its place
///   u16  by how many events the last chunk is not full
/// and for each chunk
///   u8   the filter mask (1 = stored without the filter)
///   u16  the number of bytes, which follow
/// Empty when the HDF5 library does not take them.
[[nodiscard]] std::vector<uint8_t> make_chunk_file(std::span<const uint8_t> input);

/// The bytes of a small HDF5 file with the columns of the DSEC layout.
[[nodiscard]] std::vector<uint8_t> make_column_file(const recordings::EventColumns& events);

}  // namespace e2lf::fuzz
