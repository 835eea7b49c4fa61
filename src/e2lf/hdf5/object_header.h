// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace e2lf::hdf5 {

/// False where a piece of an object header (its beginning or a continuation, of either version, as the library reads
/// them) holds a data layout whose chunks have no dimension: HDF5 1.10 takes it for sound and divides by zero. HDF5
/// file format specification, IV.A and IV.A.2.i. Whatever else is wrong with the piece is left to the library.
[[nodiscard]] bool chunks_have_dimensions(std::span<const uint8_t> piece);

}  // namespace e2lf::hdf5
