// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>

#include "e2lf/engine/aligned_buffer.h"
#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

using kernels::Bfloat16, kernels::kPanelWidth, kernels::to_bfloat16, kernels::to_float;

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
