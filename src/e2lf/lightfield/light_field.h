// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "e2lf/base/memory.h"
#include "e2lf/base/result.h"
#include "e2lf/base/strided_view.h"

namespace e2lf::lightfield {

/// The extents of a light field; `channels` is 1 (grey) or 3 (red, green, blue).
struct Shape {
  size_t views_y = 0, views_x = 0, height = 0, width = 0, channels = 1;

  [[nodiscard]] size_t num_views() const { return views_y * views_x; }
  [[nodiscard]] size_t view_size() const { return height * width * channels; }
  [[nodiscard]] size_t size() const { return num_views() * view_size(); }
  bool operator==(const Shape&) const = default;
};

/// Returns the shape of the light field behind a view.
[[nodiscard]] inline Shape shape_of(const LightFieldView& view) {
  return {view.extents[0], view.extents[1], view.extents[2], view.extents[3], view.extents[4]};
}

/// A 4-D light field: float32 [view_y, view_x, y, x] (grey) or [view_y, view_x, y, x, channel], row-major, with values
/// in [0, 1]. The view number is views_x * view_y + view_x. The disparity d is in px per view step: a point at x in
/// view (r, c) is at x + d in view (r, c + 1), and likewise for rows.
class LightField {
 public:
  LightField() = default;
  explicit LightField(const Shape& shape) : shape_(shape), data_(shape.size(), 0.0F) {}
  LightField(const Shape& shape, std::span<const float> data) : shape_(shape), data_(data.begin(), data.end()) {
    E2LF_REQUIRE(data_.size() == shape_.size(), "the data of a light field must fill its shape");
  }
  /// Copies the light field behind a view.
  explicit LightField(const LightFieldView& view) : shape_(shape_of(view)), data_(view.size()) {
    copy_values(view, LightFieldOutput(*this));
  }
  /// Returns a light field whose values are not set, for a caller that sets all of them.
  [[nodiscard]] static LightField unset(const Shape& shape) {
    LightField field;
    field.shape_ = shape;
    field.data_.resize(shape.size());
    return field;
  }

  [[nodiscard]] const Shape& shape() const { return shape_; }
  [[nodiscard]] std::span<float> data() { return data_; }
  [[nodiscard]] std::span<const float> data() const { return data_; }

  /// Returns one view, [y, x] or [y, x, channel].
  [[nodiscard]] std::span<float> view(size_t view_y, size_t view_x) {
    return data().subspan(offset(view_y, view_x), shape_.view_size());
  }
  [[nodiscard]] std::span<const float> view(size_t view_y, size_t view_x) const {
    return data().subspan(offset(view_y, view_x), shape_.view_size());
  }

  operator LightFieldView() const { return {data_.data(), extents()}; }
  operator LightFieldOutput() { return {data_.data(), extents()}; }

  [[nodiscard]] float& at(size_t view_y, size_t view_x, size_t y, size_t x, size_t channel = 0) {
    return data_[offset(view_y, view_x) + (y * shape_.width + x) * shape_.channels + channel];
  }
  [[nodiscard]] float at(size_t view_y, size_t view_x, size_t y, size_t x, size_t channel = 0) const {
    return data_[offset(view_y, view_x) + (y * shape_.width + x) * shape_.channels + channel];
  }

 private:
  [[nodiscard]] std::array<size_t, 5> extents() const {
    return {shape_.views_y, shape_.views_x, shape_.height, shape_.width, shape_.channels};
  }
  [[nodiscard]] size_t offset(size_t view_y, size_t view_x) const {
    E2LF_ASSERT(view_y < shape_.views_y && view_x < shape_.views_x);
    return (view_y * shape_.views_x + view_x) * shape_.view_size();
  }
  Shape shape_;
  UninitialisedVector<float> data_;
};

}  // namespace e2lf::lightfield
