// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace e2lf::hdf5 {

/// Returns false if a piece of an object header (its beginning or a continuation, of either version) holds a data
/// layout whose chunks have no dimension. HDF5 1.10 accepts such a layout and divides by zero. Source: HDF5 file format
/// specification, IV.A and IV.A.2.i. All other damage is left to the library.
[[nodiscard]] bool chunks_have_dimensions(std::span<const uint8_t> piece);

}  // namespace e2lf::hdf5
