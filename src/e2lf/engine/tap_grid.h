// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/engine/conv.h"

namespace e2lf::engine {

/// The positions of the taps of a convolution that sums them one by one. In a transposed convolution, each output pixel
/// has exactly one tap, which is determined by its position within the stride (the phase).
struct TapGrid {
  explicit TapGrid(const ConvSpec& spec)
      : kernel(spec.kernel),
        stride(spec.stride),
        transposed(spec.transposed),
        radius(spec.stride == spec.kernel ? 0 : spec.kernel / 2),
        in_stride(padded_channels(spec.in_channels)) {}

  [[nodiscard]] Reach reach() const {
    if (transposed) return {0, 0, 1, stride};
    // `down` already counts the pixels that the kernel's centre covers in the last step of a stride.
    return {radius, radius > stride - 1 ? radius - (stride - 1) : 0, stride, 1};
  }

  /// Returns the number of sums along a row, without phases: inputs of a transposed convolution, and outputs otherwise.
  [[nodiscard]] size_t sums_per_row(const Strip& strip) const {
    return transposed ? strip.width / stride : strip.width;
  }
  [[nodiscard]] size_t phases() const { return transposed ? stride : 1; }

  /// Returns the distance in elements from the input of one sum to that of the next.
  [[nodiscard]] size_t pixel_step() const { return (transposed ? 1 : stride) * in_stride; }

  /// Returns the input of sum `x` in output row `y` under tap (dy, dx), or under its one tap if the convolution is
  /// transposed.
  template <typename T>
  [[nodiscard]] const T* input(const Strip& strip, size_t y, size_t x, size_t dy = 0, size_t dx = 0) const {
    if (transposed) return strip.inputs[0].row<const T>(static_cast<ptrdiff_t>(y / stride)) + x * in_stride;
    const auto in_y = static_cast<ptrdiff_t>(y * stride + dy) - static_cast<ptrdiff_t>(radius);
    const auto in_x = static_cast<ptrdiff_t>(x * stride + dx) - static_cast<ptrdiff_t>(radius);
    return strip.inputs[0].row<const T>(in_y) + in_x * static_cast<ptrdiff_t>(in_stride);
  }

  size_t kernel, stride;
  bool transposed;
  size_t radius;
  size_t in_stride;  ///< elements of an input pixel
};

}  // namespace e2lf::engine
