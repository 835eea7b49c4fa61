// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "e2lf/files/npy.h"

namespace e2lf {

/// So many bytes hold the header of nearly every file.
inline constexpr size_t kNpyHeadBytes = size_t{64} << 10;

/// What a .npy header says, without the data.
struct NpyHeader {
  struct Number {
    size_t offset = 0, size = 0;
  };
  NpyArray array;                  ///< with no bytes yet
  std::vector<Number> big_endian;  ///< numbers within an item whose bytes must be reversed
  bool fortran_order = false;
  size_t data_offset = 0;  ///< from the start of the file
  size_t data_size = 0;
};

/// Parses the header of a .npy file from its first bytes, which must hold it whole. Fails with kTruncated when they do
/// not, kFormat (not a numpy header) and kUnsupported (complex, text or nested elements).
[[nodiscard]] Result<NpyHeader> parse_npy_header(std::span<const uint8_t> bytes, const std::string& name);

/// The header's bytes, magic included, for a little-endian array in C order.
[[nodiscard]] std::vector<uint8_t> npy_header_bytes(const NpyArray& array);

}  // namespace e2lf
