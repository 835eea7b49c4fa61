// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "e2lf/engine/kernel.h"
#include "e2lf/engine/row_memory.h"

namespace e2lf::engine {

using kernels::assign, kernels::Bfloat16, kernels::kPanelWidth, kernels::to_bfloat16, kernels::to_float;

/// Matrices [depth, columns] in the order in which the multiplication reads them: panel by panel of columns, and row by
/// row within a panel (bfloat16 and int16: by pairs of rows, with the two elements of a column side by side). Columns
/// are padded to kChannelMultiple, and depth to an even number, with zeros. Panels that are as wide as a kernel's sums
/// make it read the weights in the order of memory; the width must be a power of two.
class PackedMatrices {
 public:
  using Element = std::function<float(size_t matrix, size_t row, size_t column)>;

  PackedMatrices() = default;
  PackedMatrices(ElementType type, size_t count, size_t depth, size_t columns, const Element& element,
                 size_t panel_width = kPanelWidth);

  [[nodiscard]] size_t depth() const { return depth_; }      ///< padded
  [[nodiscard]] size_t columns() const { return columns_; }  ///< padded

  /// Returns rows [0, depth) of the panel that begins at `column` (a multiple of the panel width). Its width, and the
  /// number of elements per row, is min(panel width, columns() - column).
  template <typename T>
  [[nodiscard]] const T* panel(size_t matrix, size_t column) const {
    return buffer_.as<T>() + (matrix * columns_ + column) * depth_;
  }

 private:
  size_t depth_ = 0;
  size_t columns_ = 0;
  AlignedBuffer buffer_;
};

/// Weights as integers: column c of the matrices is `units[c]` times the integers.
struct ScaledWeights {
  PackedMatrices weights;
  std::vector<float> units;
};

/// Packs matrices as int16, with units so that sums of products with int16 over the rows of `summed` matrices (1 or
/// all) do not overflow int32.
[[nodiscard]] ScaledWeights pack_int16(size_t count, size_t depth, size_t columns,
                                       const PackedMatrices::Element& element, size_t summed, size_t panel_width);

}  // namespace e2lf::engine
