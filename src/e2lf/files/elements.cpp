// SPDX-License-Identifier: MIT
#include "e2lf/files/elements.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/files/npy.h"

namespace e2lf {

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
    for (size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(load_element<T>(bytes.data() + i * sizeof(T)));
  });
  if (known) return values;
  return fail(ErrorCode::kUnsupported, name, "elements of type \"", code, "\" are not numbers; store plain numbers");
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

size_t NpyArray::num_elements() const {
  return std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>());
}

Result<std::vector<float>> NpyArray::to_float(const std::string& name) const {
  if (fields.empty()) return elements_to_float(type, bytes, name);
  return fail(ErrorCode::kUnsupported, name, "an array of records where plain numbers are expected; store one field");
}

}  // namespace e2lf
