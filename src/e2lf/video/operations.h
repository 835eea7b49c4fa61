// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/engine/operation.h"

namespace e2lf::video {

/// The names of the operations that networks for frames have beside those of model::Op.
struct VideoOp : model::Op {
  static constexpr const char* kTanh = "tanh";
  /// Bilinear by `stride`: output pixel i lies at (i + 1/2) / stride - 1/2; edge pixels are repeated.
  static constexpr const char* kUpsampleBilinear = "upsample-bilinear";
  /// Each pixel has its own filters: inputs x [C] and f [M kernel^2] give [M C], where out[m C + c](y, x) = sum over
  /// dy, dx of f[(m kernel + dy) kernel + dx](y, x) x[c](y + dy - r, x + dx - r), r = kernel / 2 (odd kernel).
  static constexpr const char* kDynamicFilter = "dynamic-filter";
  /// Normalises each pixel over its channels: (x - mean) / sqrt(variance + 1e-5) * weight + bias, with weight and bias
  /// [channels].
  static constexpr const char* kLayerNorm = "layer-norm";
  /// Adds a code of the position of the pixel: for pixel n = y width + x, channel 2 i gets sin(n / 10000^(2 i / C)),
  /// and channel 2 i + 1 the cosine.
  static constexpr const char* kPositionCode = "position-code";
  /// Multi-head attention between all pixels: inputs q, k, v [C], whose channels are `heads` (an attribute) equal
  /// parts; each part of pixel i is the sum over pixels j of softmax_j(q_i . k_j / sqrt(C / heads)) v_j.
  static constexpr const char* kAttention = "attention";
  /// Output of the last layer for the previous frame, initially zero; no inputs, out_channels as in that layer.
  static constexpr const char* kPrevious = "previous";

  // Cells with a memory of the previous frame, which is initially zero. * is the "same" convolution with `kernel`
  // (odd), and [a, b] is kConcat. The input is x and the result h. The weights of the convolutions are "<name>.gates"
  // (kConvGru: 2 out = u, r; kConvLstm: 4 out = i, f, o, g) and, for kConvGru only, "<name>.candidate" (out).

  /// (u, r) = sigmoid(gates * [x, h']), h = (1 - u) h' + u tanh(candidate * [x, r h']); h' is the previous h.
  static constexpr const char* kConvGru = "conv-gru";
  /// (i, f, o) = sigmoid and g = tanh of the parts of gates * [x, h']; c = f c' + i g, h = o tanh(c).
  static constexpr const char* kConvLstm = "conv-lstm";
};

/// Adds these operations to the process, unless they are there. Functions of this module that read, import or build
/// networks do so themselves.
void add_operations();

// The operations.
[[nodiscard]] engine::Operation attention();
[[nodiscard]] engine::Operation bilinear_upsampling();
[[nodiscard]] engine::Operation conv_gru();
[[nodiscard]] engine::Operation conv_lstm();
[[nodiscard]] engine::Operation dynamic_filter();
[[nodiscard]] engine::Operation layer_norm();
[[nodiscard]] engine::Operation position_code();
[[nodiscard]] engine::Operation previous_output();
[[nodiscard]] engine::Operation hyperbolic_tangent();

}  // namespace e2lf::video
