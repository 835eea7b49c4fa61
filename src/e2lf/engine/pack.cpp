// SPDX-License-Identifier: MIT
#include "e2lf/engine/pack.h"

#include <algorithm>

namespace e2lf::engine {

PackedMatrices::PackedMatrices(ElementType type, size_t count, size_t depth, size_t columns, const Element& element,
                               size_t panel_width)
    : depth_(round_up(depth, 2)),
      columns_(padded_channels(columns)),
      buffer_(count * depth_ * columns_ * element_size(type)) {
  for (size_t matrix = 0; matrix < count; ++matrix) {
    for (size_t row = 0; row < depth; ++row) {
      for (size_t column = 0; column < columns; ++column) {
        const size_t begin = column / panel_width * panel_width;
        const size_t width = std::min(panel_width, columns_ - begin);
        const size_t panel = (matrix * columns_ + begin) * depth_;
        const float value = element(matrix, row, column);
        if (type == ElementType::kFloat32) {
          buffer_.as<float>()[panel + row * width + column - begin] = value;
        } else {
          buffer_.as<Bfloat16>()[panel + row / 2 * 2 * width + (column - begin) * 2 + row % 2] = to_bfloat16(value);
        }
      }
    }
  }
}

}  // namespace e2lf::engine
