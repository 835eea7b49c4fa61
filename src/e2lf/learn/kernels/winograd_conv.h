// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace e2lf::learn {

/// The shape of a 3x3 convolution with stride 1 and zero padding. Tensors are float32 [image, y, x, channel], dense.
struct ConvShape {
  size_t images, height, width, in_channels, out_channels;
};

/// Returns the number of tiles of 4x4 outputs per image, on which Winograd's F(4x4, 3x3) operates. Tiles that extend
/// beyond the right or bottom edge are cropped.
[[nodiscard]] size_t tiles_per_image(const ConvShape& shape);

/// Returns the number of elements of 36 matrices [rows, columns] with padded columns, the form in which weights are
/// multiplied.
[[nodiscard]] size_t winograd_matrices_size(size_t rows, size_t columns);

/// Transforms weights from taps [3, 3, rows, columns] to matrices. `conv_forward` expects rows = input channels and
/// columns = output channels, and `conv_backward` the reverse.
void to_winograd_matrices(const float* taps, size_t rows, size_t columns, float* matrices);

/// Computes the adjoint of to_winograd_matrices(): transforms the gradients of the matrices [in, out] to those of the
/// taps [3, 3, in, out].
void from_winograd_matrices(const float* matrices, size_t rows, size_t columns, float* taps);

/// Arguments of y = convolution of x + bias + residual, followed by ReLU if `relu`.
struct ConvForward {
  const float* x;
  const float* matrices;  ///< [in, out], aligned to 64 bytes
  const float* bias;
  const float* residual;  ///< like y; null if there is none
  bool relu;
  float* y;
};

/// Computes the tiles [first, end) of all images together.
void conv_forward(const ConvShape& shape, const ConvForward& job, size_t first, size_t end);

/// Arguments of the gradients of a convolution with bias and, if `y` is not null, ReLU.
struct ConvBackward {
  const float* x;
  const float* matrices;  ///< [out, in], aligned to 64 bytes
  const float* y;         ///< the output of a convolution with ReLU, or null
  const float* dy;
  float* dx;         ///< the gradient is added; null if it is not needed
  float* dmatrices;  ///< [in, out], the gradient is added
  float* dbias;      ///< the gradient is added
};

/// Computes the contribution of the images [first, end).
void conv_backward(const ConvShape& shape, const ConvBackward& job, size_t first, size_t end);

}  // namespace e2lf::learn
