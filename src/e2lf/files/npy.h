// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf {

/// One field of a structured (record) array: name, numpy type code without byte order ("u2", "i8"), byte offset.
struct NpyField {
  std::string name;
  std::string type;
  size_t offset = 0;
};

/// A numpy array as stored: row-major little-endian bytes with their shape and type.
struct NpyArray {
  std::string type;              ///< numpy code without byte order: "f4", "i2", "u1", "b1", ...; empty for records
  std::vector<NpyField> fields;  ///< for records only
  size_t item_size = 0;          ///< bytes per element or record
  std::vector<size_t> shape;
  std::vector<uint8_t> bytes;

  [[nodiscard]] size_t num_elements() const;

  /// The elements as float32 or int32, converted from any numeric type. int32 fails with kInvalidValue where a value
  /// does not fit or is not whole. `name` is the location in errors.
  [[nodiscard]] Result<std::vector<float>> to_float(const std::string& name) const;
  [[nodiscard]] Result<std::vector<int32_t>> to_int32(const std::string& name) const;
};

/// An array of that shape for float, double, uint8_t, int8_t, int16_t, uint16_t, int32_t or int64_t.
template <typename T>
[[nodiscard]] NpyArray make_npy(std::vector<size_t> shape, std::span<const T> values);

/// Decodes / encodes a .npy file in memory: version 1 to 3, C or Fortran order (turned to C), either byte order (turned
/// to little). A header that claims more than the file holds is kTruncated; nothing is allocated on its word.
[[nodiscard]] Result<NpyArray> decode_npy(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] std::vector<uint8_t> encode_npy(const NpyArray& array);

[[nodiscard]] Result<NpyArray> read_npy(const std::filesystem::path& path);

/// Type and shape as the header says, with no bytes: tells what a file holds without reading it. Fails as decode_npy
/// does, but does not notice missing data.
[[nodiscard]] Result<NpyArray> peek_npy(const std::filesystem::path& path);

[[nodiscard]] Result<void> write_npy(const std::filesystem::path& path, const NpyArray& array);

using NpzArrays = std::map<std::string, NpyArray>;

/// Reads / writes a .npz archive (zip of .npy members, stored or deflated, zip64 where needed). Names come without
/// ".npy"; members that are not arrays are passed over. Writing compresses with deflate when `compress`; equal arrays
/// give equal bytes. Fails with kFormat (a member twice, sizes that do not agree), kTruncated, kUnsupported (another
/// compression method), and kInvalidValue (a checksum that does not match). Memory follows what really unpacks.
[[nodiscard]] Result<NpzArrays> decode_npz(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] std::vector<uint8_t> encode_npz(const NpzArrays& arrays, bool compress = true);

[[nodiscard]] Result<NpzArrays> read_npz(const std::filesystem::path& path);

/// Names, types and shapes of the arrays, with no bytes: tells what an archive holds without unpacking it. Fails as
/// decode_npz does, but does not notice damaged data.
[[nodiscard]] Result<NpzArrays> peek_npz(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] Result<NpzArrays> peek_npz(const std::filesystem::path& path);

[[nodiscard]] Result<void> write_npz(const std::filesystem::path& path, const NpzArrays& arrays, bool compress = true);

}  // namespace e2lf
