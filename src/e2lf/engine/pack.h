// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>

#include "e2lf/engine/aligned_buffer.h"
#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// A bfloat16 number: the upper half of a float32.
struct Bfloat16 {
  uint16_t bits = 0;
};

/// To the nearest, ties to even; values are finite.
[[nodiscard]] inline Bfloat16 to_bfloat16(float value) {
  uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  return {static_cast<uint16_t>((bits + 0x7FFFU + ((bits >> 16U) & 1U)) >> 16U)};
}

[[nodiscard]] inline float to_float(Bfloat16 value) {
  const uint32_t bits = static_cast<uint32_t>(value.bits) << 16U;
  float result = 0.0F;
  std::memcpy(&result, &bits, sizeof(result));
  return result;
}

/// Output channels of a matrix are packed in panels of at most this many.
inline constexpr size_t kPanelWidth = 64;

/// Matrices [depth, columns] in the order in which the multiplication reads them: panel by panel of columns, in a panel
/// row by row (bfloat16: pairs of rows, the two elements of a column beside each other). Columns are padded to
/// kChannelMultiple, depth to an even number, with zeros.
class PackedMatrices {
 public:
  using Element = std::function<float(size_t matrix, size_t row, size_t column)>;

  PackedMatrices() = default;
  PackedMatrices(ElementType type, size_t count, size_t depth, size_t columns, const Element& element);

  [[nodiscard]] size_t depth() const { return depth_; }      ///< padded
  [[nodiscard]] size_t columns() const { return columns_; }  ///< padded

  /// Rows [0, depth) of the panel that begins at `column` (a multiple of kPanelWidth); its width is
  /// min(kPanelWidth, columns() - column), and each row has that many elements.
  template <typename T>
  [[nodiscard]] const T* panel(size_t matrix, size_t column) const {
    return buffer_.as<T>() + (matrix * columns_ + column) * depth_;
  }

 private:
  size_t depth_ = 0;
  size_t columns_ = 0;
  AlignedBuffer buffer_;
};

}  // namespace e2lf::engine
