// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/result.h"

namespace e2lf {

/// Numbers of arrays that are no types of C++.
struct Bool {
  using Plain = uint8_t;
  uint8_t byte;
  operator uint8_t() const { return byte != 0 ? 1 : 0; }
};

struct Bfloat16 {
  using Plain = float;
  uint16_t bits;
  operator float() const { return std::bit_cast<float>(uint32_t{bits} << 16); }
};

struct Half {
  using Plain = float;
  uint16_t bits;
  operator float() const {
    const uint32_t sign = static_cast<uint32_t>(bits & 0x8000U) << 16;
    const uint32_t exponent = (bits >> 10) & 31U;
    const uint32_t mantissa = bits & 0x3FFU;
    if (exponent == 0) {  // zero and subnormals: mantissa * 2^-24
      const float magnitude = static_cast<float>(mantissa) * 0x1p-24F;
      return sign != 0 ? -magnitude : magnitude;
    }
    const uint32_t wide = exponent == 31 ? 255 : exponent + 112;
    return std::bit_cast<float>(sign | (wide << 23) | (mantissa << 13));
  }
};

/// Calls visit(T{}) with the type of a code, which load_element<T>() reads. Returns false for an unknown code.
template <typename Visit>
bool with_element_type(std::string_view code, Visit&& visit) {
  if (code == "f4") return visit(float{}), true;
  if (code == "i2") return visit(int16_t{}), true;
  if (code == "u1") return visit(uint8_t{}), true;
  if (code == "i1") return visit(int8_t{}), true;
  if (code == "u2") return visit(uint16_t{}), true;
  if (code == "i4") return visit(int32_t{}), true;
  if (code == "u4") return visit(uint32_t{}), true;
  if (code == "i8") return visit(int64_t{}), true;
  if (code == "u8") return visit(uint64_t{}), true;
  if (code == "f8") return visit(double{}), true;
  if (code == "b1") return visit(Bool{}), true;
  if (code == "f2") return visit(Half{}), true;
  if (code == "bf16") return visit(Bfloat16{}), true;
  return false;
}

/// Returns the little-endian element at `bytes` as a number of C++: Bool as uint8_t, Half and Bfloat16 as float.
template <typename T>
auto load_element(const uint8_t* bytes) {
  if constexpr (std::is_arithmetic_v<T>) {
    return load_le<T>(bytes);
  } else {
    return static_cast<typename T::Plain>(load_le<T>(bytes));
  }
}

/// Returns the size in bytes of an element with this numpy type code ("b1", "i1".."i8", "u1".."u8", "f2", "f4", "f8")
/// or "bf16", and 0 for other codes.
[[nodiscard]] size_t element_size(std::string_view code);

/// Converts little-endian elements of that type to float32. `name` is the location in errors. Fails with kUnsupported
/// for an unknown code.
[[nodiscard]] Result<std::vector<float>> elements_to_float(std::string_view code, std::span<const uint8_t> bytes,
                                                           const std::string& name);

/// Returns the product of the extents and `item_size`. Fails with kFormat if it does not fit into a size_t, where
/// extents of zero are counted as one so that they do not hide an overflow.
[[nodiscard]] Result<size_t> checked_byte_size(std::span<const size_t> shape, size_t item_size,
                                               const std::string& location);

/// One field of a structured (record) array: its name, its numpy type code without byte order ("u2", "i8"), and its
/// byte offset.
struct NpyField {
  std::string name;
  std::string type;
  size_t offset = 0;
};

/// A numpy array as it is stored: row-major little-endian bytes with their shape and type.
struct NpyArray {
  std::string
      type;  ///< numpy type code without byte order: "f4", "i2", "u1", "b1", ..., or "bf16" (Tensor); empty for records
  std::vector<NpyField> fields;  ///< the fields of records; empty for other types
  size_t item_size = 0;          ///< bytes per element or record
  std::vector<size_t> shape;
  std::vector<uint8_t> bytes;

  [[nodiscard]] size_t num_elements() const;

  /// Converts the elements from any numeric type to float32. `name` is the location in errors.
  [[nodiscard]] Result<std::vector<float>> to_float(const std::string& name) const;
};

/// Makes an array of that shape. T is a type of numbers of C++.
template <typename T>
[[nodiscard]] NpyArray make_npy(std::vector<size_t> shape, std::span<const T> values) {
  const auto* const bytes = reinterpret_cast<const uint8_t*>(values.data());
  const char kind = std::is_floating_point_v<T> ? 'f' : std::is_signed_v<T> ? 'i' : 'u';
  NpyArray array{
      kind + std::to_string(sizeof(T)), {}, sizeof(T), std::move(shape), {bytes, bytes + values.size_bytes()}};
  E2LF_REQUIRE(array.num_elements() == values.size(), "the shape does not fit the values");
  return array;
}

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

/// Decodes or encodes a .npy file in memory. Versions 1 to 3, C and Fortran order, and both byte orders are read, and
/// the array is converted to C order and little-endian bytes. Fails with kTruncated if the header claims more data than
/// the file holds; nothing is allocated before that is checked.
[[nodiscard]] Result<NpyArray> decode_npy(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] std::vector<uint8_t> encode_npy(const NpyArray& array);

[[nodiscard]] Result<NpyArray> read_npy(const std::filesystem::path& path);

/// Reads the type and shape from the header and leaves the bytes empty, so that the content of a file is known without
/// reading it. Fails as decode_npy does, but does not detect missing data.
[[nodiscard]] Result<NpyArray> peek_npy(const std::filesystem::path& path);

[[nodiscard]] Result<void> write_npy(const std::filesystem::path& path, const NpyArray& array);

using NpzArrays = std::map<std::string, NpyArray>;

/// Decodes or encodes a .npz archive (a zip of .npy members, stored or deflated, with zip64 if needed). The names come
/// without ".npy", and members that are not arrays are skipped. `compress` selects deflate for writing; equal arrays
/// give equal bytes. Decoding fails with kFormat (a duplicate member, or inconsistent sizes), kTruncated, kUnsupported
/// (another compression method) and kInvalidValue (a wrong checksum). Memory grows with the data that are actually
/// unpacked.
[[nodiscard]] Result<NpzArrays> decode_npz(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] std::vector<uint8_t> encode_npz(const NpzArrays& arrays, bool compress = true);

[[nodiscard]] Result<NpzArrays> read_npz(const std::filesystem::path& path);

/// Returns the names, types and shapes of the arrays without their bytes, so that the content of an archive is known
/// without unpacking it. Fails as decode_npz does, but does not detect damaged data.
[[nodiscard]] Result<NpzArrays> peek_npz(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] Result<NpzArrays> peek_npz(const std::filesystem::path& path);

[[nodiscard]] Result<void> write_npz(const std::filesystem::path& path, const NpzArrays& arrays, bool compress = true);

}  // namespace e2lf
