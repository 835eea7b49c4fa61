// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
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

}  // namespace e2lf
