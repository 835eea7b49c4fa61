// SPDX-License-Identifier: MIT
#include "e2lf/engine/pack.h"

#include <algorithm>
#include <cmath>

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
          continue;
        }
        const size_t in_pairs = panel + row / 2 * 2 * width + (column - begin) * 2 + row % 2;
        if (type == ElementType::kBfloat16) {
          buffer_.as<Bfloat16>()[in_pairs] = to_bfloat16(value);
        } else {
          buffer_.as<int16_t>()[in_pairs] = static_cast<int16_t>(std::lround(value));
        }
      }
    }
  }
}

ScaledWeights pack_int16(size_t count, size_t depth, size_t columns, const PackedMatrices::Element& element,
                         size_t summed, size_t panel_width) {
  std::vector<float> scales(columns);
  ScaledWeights scaled;
  for (size_t column = 0; column < columns; ++column) {
    double sum = 0, largest_sum = 0, largest = 0;
    for (size_t matrix = 0; matrix < count; ++matrix) {
      if (matrix % summed == 0) sum = 0;
      for (size_t row = 0; row < depth; ++row) {
        const double weight = std::abs(element(matrix, row, column));
        sum += weight;
        largest = std::max(largest, weight);
      }
      largest_sum = std::max(largest_sum, sum);
    }
    // Rounding adds a half to each weight at most.
    const double most = 2.0 * INT16_MAX - static_cast<double>(summed * depth);
    scales[column] = largest > 0 ? static_cast<float>(std::min(most / largest_sum, INT16_MAX / largest)) : 1.0F;
    scaled.units.push_back(1 / scales[column]);
  }
  const auto integer = [&](size_t matrix, size_t row, size_t column) {
    return element(matrix, row, column) * scales[column];
  };
  scaled.weights = {ElementType::kInt16, count, depth, columns, integer, panel_width};
  return scaled;
}

}  // namespace e2lf::engine
