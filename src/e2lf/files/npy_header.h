// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "e2lf/files/npy.h"

namespace e2lf {

/// The number of bytes that contain the header of nearly every file.
inline constexpr size_t kNpyHeadBytes = size_t{64} << 10;

/// The contents of a .npy header, without the data.
struct NpyHeader {
  struct Number {
    size_t offset = 0, size = 0;
  };
  NpyArray array;                  ///< the array, whose bytes are still empty
  std::vector<Number> big_endian;  ///< the numbers within an item whose bytes must be reversed
  bool fortran_order = false;
  size_t data_offset = 0;  ///< position of the data from the start of the file
  size_t data_size = 0;
};

/// Parses the header of a .npy file from its first bytes, which must contain all of it. Fails with kTruncated if they
/// do not, with kFormat if it is not a numpy header, and with kUnsupported for complex, text or nested elements.
[[nodiscard]] Result<NpyHeader> parse_npy_header(std::span<const uint8_t> bytes, const std::string& name);

/// Returns the bytes of the header, magic string included, for a little-endian array in C order.
[[nodiscard]] std::vector<uint8_t> npy_header_bytes(const NpyArray& array);

}  // namespace e2lf
