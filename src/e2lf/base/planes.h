// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/strided_view.h"

namespace e2lf {

/// Images of the same size: T [image, y, x], row-major.
template <typename T>
struct Planes {
  size_t count = 0, height = 0, width = 0;
  std::vector<T> values;

  Planes() = default;
  Planes(size_t count_, size_t height_, size_t width_)
      : count(count_), height(height_), width(width_), values(count_ * height_ * width_) {}

  /// Changes the sizes and reuses the memory. The values are unspecified.
  void resize(size_t count_, size_t height_, size_t width_) {
    count = count_;
    height = height_;
    width = width_;
    values.resize(count * height * width);
  }

  [[nodiscard]] size_t image_size() const { return height * width; }
  [[nodiscard]] std::span<T> image(size_t n) { return std::span(values).subspan(n * image_size(), image_size()); }
  [[nodiscard]] std::span<const T> image(size_t n) const {
    return std::span(values).subspan(n * image_size(), image_size());
  }
  operator PlanesView<T>() { return {values.data(), {count, height, width}}; }
  operator PlanesView<const T>() const { return {values.data(), {count, height, width}}; }
  bool operator==(const Planes&) const = default;
};

/// Returns a copy that owns its memory.
template <typename T>
[[nodiscard]] Planes<std::remove_const_t<T>> owned(const PlanesView<T>& view) {
  Planes<std::remove_const_t<T>> planes(view.extents[0], view.extents[1], view.extents[2]);
  copy_values(view, PlanesView<std::remove_const_t<T>>(planes));
  return planes;
}

}  // namespace e2lf
