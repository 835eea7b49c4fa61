// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

namespace e2lf {

/// Values in memory that somebody else owns, on a grid of kAxes axes. The strides are in values and may be zero or
/// negative. The functions that take views copy at most a part at a time, where their arithmetic needs neighbours.
template <typename T, size_t kAxes>
struct StridedView {
  using Value = std::remove_const_t<T>;
  T* data = nullptr;
  std::array<size_t, kAxes> extents{};
  std::array<ptrdiff_t, kAxes> strides{};

  StridedView() = default;
  StridedView(T* data_, const std::array<size_t, kAxes>& extents_, const std::array<ptrdiff_t, kAxes>& strides_)
      : data(data_), extents(extents_), strides(strides_) {}
  /// Describes row-major memory.
  StridedView(T* data_, const std::array<size_t, kAxes>& extents_) : data(data_), extents(extents_) {
    ptrdiff_t stride = 1;
    for (size_t axis = kAxes; axis-- > 0; stride *= static_cast<ptrdiff_t>(extents[axis])) strides[axis] = stride;
  }
  operator StridedView<const T, kAxes>() const  // NOLINT(google-explicit-constructor)
      requires(!std::is_const_v<T>) {
    return {data, extents, strides};
  }

  [[nodiscard]] size_t size() const {
    size_t product = 1;
    for (const size_t extent : extents) product *= extent;
    return product;
  }
  [[nodiscard]] bool is_row_major() const {
    ptrdiff_t stride = 1;
    for (size_t axis = kAxes; axis-- > 0; stride *= static_cast<ptrdiff_t>(extents[axis])) {
      if (extents[axis] != 1 && strides[axis] != stride) return false;
    }
    return true;
  }

  /// Returns the part with this index along the first axis, or the value if there is one axis.
  [[nodiscard]] decltype(auto) operator[](size_t index) const {
    T* const part = data + static_cast<ptrdiff_t>(index) * strides[0];
    if constexpr (kAxes == 1) {
      return *part;
    } else {
      StridedView<T, kAxes - 1> rest;
      rest.data = part;
      std::copy(extents.begin() + 1, extents.end(), rest.extents.begin());
      std::copy(strides.begin() + 1, strides.end(), rest.strides.begin());
      return rest;
    }
  }

  /// Returns the value with this number in row-major order.
  [[nodiscard]] T& value(size_t number) const {
    ptrdiff_t offset = 0;
    for (size_t axis = kAxes; axis-- > 0; number /= extents[axis]) {
      offset += static_cast<ptrdiff_t>(number % extents[axis]) * strides[axis];
    }
    return data[offset];
  }

  /// Returns the same values with one axis in the opposite direction.
  [[nodiscard]] StridedView reversed(size_t axis) const {
    StridedView other = *this;
    if (extents[axis] > 0) other.data += static_cast<ptrdiff_t>(extents[axis] - 1) * strides[axis];
    other.strides[axis] = -strides[axis];
    return other;
  }

  /// Returns the values [first, first + count) in row-major order: in place if they are consecutive, or else copied to
  /// `scratch`.
  [[nodiscard]] std::span<const Value> values(std::vector<Value>& scratch, size_t first, size_t count) const {
    if (is_row_major()) return {data + first, count};
    scratch.resize(count);
    // Axes that follow one another as in row-major memory are one.
    size_t run = 1, axis = kAxes;
    ptrdiff_t step = 1;
    while (axis > 0 &&
           (run == 1 || extents[axis - 1] == 1 || strides[axis - 1] == step * static_cast<ptrdiff_t>(run))) {
      --axis;
      if (run == 1) step = strides[axis];
      run *= extents[axis];
    }
    for (size_t done = 0; done < count;) {
      const T* const from = &value(first + done);
      const size_t length = std::min(count - done, run - (first + done) % run);
      for (size_t i = 0; i < length; ++i) scratch[done + i] = from[static_cast<ptrdiff_t>(i) * step];
      done += length;
    }
    return scratch;
  }
  [[nodiscard]] std::span<const Value> values(std::vector<Value>& scratch) const { return values(scratch, 0, size()); }
};

/// Images of the same size, [image, y, x], as in Planes.
template <typename T>
using PlanesView = StridedView<T, 3>;

/// A light field [view_y, view_x, y, x, channel], as in lightfield::LightField, to be read and to be written.
using LightFieldView = StridedView<const float, 5>;
using LightFieldOutput = StridedView<float, 5>;

/// Calls body(value) for all values in row-major order.
template <typename T, size_t kAxes, typename Body>
void for_each_value(const StridedView<T, kAxes>& view, Body&& body) {
  if (view.is_row_major()) {
    for (T& value : std::span(view.data, view.size())) body(value);
    return;
  }
  for (size_t i = 0; i < view.extents[0]; ++i) {
    if constexpr (kAxes == 1) {
      body(view[i]);
    } else {
      for_each_value(view[i], body);
    }
  }
}

/// Copies values between views of the same extents.
template <typename From, typename T, size_t kAxes>
void copy_values(const StridedView<From, kAxes>& from, const StridedView<T, kAxes>& to) {
  for (size_t i = 0; i < to.extents[0]; ++i) {
    if constexpr (kAxes == 1) {
      to[i] = from[i];
    } else if (from[i].is_row_major() && to[i].is_row_major()) {
      std::copy_n(from[i].data, to[i].size(), to[i].data);
    } else {
      copy_values(from[i], to[i]);
    }
  }
}

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
