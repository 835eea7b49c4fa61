// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace e2lf::learn {

/// A 3x3 convolution of stride 1 with a border of zeros. Tensors are float32 [image, y, x, channel], dense.
struct ConvShape {
  size_t images, height, width, in_channels, out_channels;
};

/// Winograd's F(4x4, 3x3) works on tiles of 4x4 outputs; what is left over at the right and bottom is cut off.
[[nodiscard]] size_t tiles_per_image(const ConvShape& shape);

/// Elements of 36 matrices [rows, columns], columns padded; the form in which weights are multiplied.
[[nodiscard]] size_t winograd_matrices_size(size_t rows, size_t columns);

/// Transforms 3x3 weights: taps [3, 3, rows, columns] to matrices. `conv_forward` needs rows = input and columns =
/// output channels, `conv_backward` the other way round.
void to_winograd_matrices(const float* taps, size_t rows, size_t columns, float* matrices);

/// The adjoint: gradients of matrices [in, out] to those of the taps [3, 3, in, out].
void from_winograd_matrices(const float* matrices, size_t rows, size_t columns, float* taps);

/// y = convolution of x + bias + residual, at least 0 with `relu`.
struct ConvForward {
  const float* x;
  const float* matrices;  ///< [in, out]
  const float* bias;
  const float* residual;  ///< like y; null without
  bool relu;
  float* y;
};

/// Computes the tiles [first, end) of all images together.
void conv_forward(const ConvShape& shape, const ConvForward& job, size_t first, size_t end);

/// Gradients of a convolution with bias and, where `y` is not null, ReLU.
struct ConvBackward {
  const float* x;
  const float* matrices;  ///< [out, in]
  const float* y;         ///< the output, of a convolution with ReLU; else null
  const float* dy;
  float* dx;         ///< added to; null where not needed
  float* dmatrices;  ///< [in, out], added to
  float* dbias;      ///< added to
};

/// Computes what the images [first, end) contribute.
void conv_backward(const ConvShape& shape, const ConvBackward& job, size_t first, size_t end);

}  // namespace e2lf::learn
