// SPDX-License-Identifier: MIT
#include "e2lf/files/elements.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "e2lf/base/text.h"

namespace e2lf {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are read and written in the byte order of memory");

struct Bool {
  uint8_t byte;
  operator uint8_t() const { return byte != 0 ? 1 : 0; }
};

struct Bfloat16 {
  uint16_t bits;
  operator float() const { return std::bit_cast<float>(uint32_t{bits} << 16); }
};

struct Half {
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

/// Calls visit(T{}) with the type of the code. Returns false for an unknown code.
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

template <typename T>
T load(std::span<const uint8_t> bytes, size_t i) {
  T value;
  std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
  return value;
}

template <typename T>
bool fits_int32(T value) {
  using Limits = std::numeric_limits<int32_t>;
  if constexpr (std::is_integral_v<T>) {
    return std::in_range<int32_t>(value);
  } else if constexpr (std::is_same_v<T, Bool>) {
    return true;
  } else {
    const auto number = static_cast<double>(value);
    return number == std::trunc(number) && number >= Limits::min() && number <= Limits::max();
  }
}

Error unsupported(std::string_view code, const std::string& name) {
  return {ErrorCode::kUnsupported, cat("elements of type \"", code, "\" are not numbers; store plain numbers"), name};
}

}  // namespace

size_t element_size(std::string_view code) {
  size_t size = 0;
  with_element_type(code, [&](auto type) { size = sizeof(type); });
  return size;
}

Result<std::vector<float>> elements_to_float(std::string_view code, std::span<const uint8_t> bytes,
                                             const std::string& name) {
  std::vector<float> values;
  const bool known = with_element_type(code, [&](auto type) {
    using T = decltype(type);
    values.resize(bytes.size() / sizeof(T));
    for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(load<T>(bytes, i));
  });
  if (!known) return unsupported(code, name);
  return values;
}

Result<std::vector<int32_t>> elements_to_int32(std::string_view code, std::span<const uint8_t> bytes,
                                               const std::string& name) {
  std::vector<int32_t> values;
  std::optional<size_t> refused;
  const bool known = with_element_type(code, [&](auto type) {
    using T = decltype(type);
    values.resize(bytes.size() / sizeof(T));
    for (size_t i = 0; i < values.size() && !refused; ++i) {
      const T value = load<T>(bytes, i);
      if (!fits_int32(value)) {
        refused = i;
      } else {
        values[i] = static_cast<int32_t>(value);
      }
    }
  });
  if (!known) return unsupported(code, name);
  if (refused) {
    return Error{ErrorCode::kInvalidValue,
                 cat("element ", *refused, " is not a whole number of 32 bits; store integer counts"), name};
  }
  return values;
}

Result<size_t> checked_byte_size(std::span<const size_t> shape, size_t item_size, const std::string& location) {
  size_t size = item_size;
  bool empty = false;
  for (const size_t extent : shape) {
    empty = empty || extent == 0;
    if (__builtin_mul_overflow(size, std::max<size_t>(extent, 1), &size)) {
      return Error{ErrorCode::kFormat, "the shape is larger than any memory; the file is damaged", location};
    }
  }
  return empty ? 0 : size;
}

}  // namespace e2lf
