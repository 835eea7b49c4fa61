// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace e2lf::hdf5 {

/// Returns false if a piece of an object header (its beginning or a continuation, of either version) holds a data
/// layout whose chunks have no dimension. One damaged byte of any chunked file does this, as fuzzing found. HDF5 1.10,
/// which Debian 12 has, accepts such a layout and divides by zero in H5Dopen2(), which ends the process. No call of the
/// library shows the layout before, and limits of the process do not help, so this check must stay until 1.10 is gone.
/// Source: HDF5 file format specification, IV.A and IV.A.2.i. All other damage is left to the library.
[[nodiscard]] bool chunks_have_dimensions(std::span<const uint8_t> piece);

}  // namespace e2lf::hdf5
