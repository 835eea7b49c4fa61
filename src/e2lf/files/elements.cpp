// SPDX-License-Identifier: MIT
#include "e2lf/files/elements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "e2lf/base/text.h"

namespace e2lf {
namespace {

template <typename T>
auto load(std::span<const uint8_t> bytes, size_t i) {
  return load_element<T>(bytes.data() + i * sizeof(T));
}

template <typename T>
bool fits_int32(T value) {
  using Limits = std::numeric_limits<int32_t>;
  if constexpr (std::is_integral_v<T>) {
    return std::in_range<int32_t>(value);
  } else {
    const auto number = static_cast<double>(value);
    return number == std::trunc(number) && number >= Limits::min() && number <= Limits::max();
  }
}

Error unsupported(std::string_view code, const std::string& name) {
  return fail(ErrorCode::kUnsupported, name, "elements of type \"", code, "\" are not numbers; store plain numbers");
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
      const auto value = load<T>(bytes, i);
      if (!fits_int32(value)) {
        refused = i;
      } else {
        values[i] = static_cast<int32_t>(value);
      }
    }
  });
  if (!known) return unsupported(code, name);
  if (refused) {
    return fail(ErrorCode::kInvalidValue, name, "element ", *refused,
                " is not a whole number of 32 bits; store integer counts");
  }
  return values;
}

Result<size_t> checked_byte_size(std::span<const size_t> shape, size_t item_size, const std::string& location) {
  size_t size = item_size;
  bool empty = false;
  for (const size_t extent : shape) {
    empty = empty || extent == 0;
    if (__builtin_mul_overflow(size, std::max<size_t>(extent, 1), &size)) {
      return fail(ErrorCode::kFormat, location, "the shape is larger than any memory; the file is damaged");
    }
  }
  return empty ? 0 : size;
}

}  // namespace e2lf
