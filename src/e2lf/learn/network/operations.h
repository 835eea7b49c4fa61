// SPDX-License-Identifier: MIT
#pragma once

#include <torch/torch.h>

#include "e2lf/model/network.h"

namespace e2lf::learn {

/// Computes a convolution or transposed convolution layer including bias, residual (none if undefined) and ReLU, with
/// the fastest method for the device and type of `input` [b, c, y, x]. The result is channels-last.
[[nodiscard]] torch::Tensor convolve(const model::Layer& layer, const torch::Tensor& input, const torch::Tensor& weight,
                                     const torch::Tensor& bias, const torch::Tensor& residual);

/// Computes the pixel shuffle [b, c * s^2, y, x] -> [b, c, y * s, x * s] and its inverse with a single copy. The
/// results are channels-last.
[[nodiscard]] torch::Tensor shuffle(const torch::Tensor& x, int64_t s);
[[nodiscard]] torch::Tensor unshuffle(const torch::Tensor& x, int64_t s);

/// Computes model::Op::kAttention on tensors [batch, channel, y, x].
[[nodiscard]] torch::Tensor attend(const torch::Tensor& queries, const torch::Tensor& keys, const torch::Tensor& values,
                                   int64_t heads);

/// Computes model::Op::kLayerNorm; `weight` and `bias` are [channel].
[[nodiscard]] torch::Tensor normalise_pixels(const torch::Tensor& x, const torch::Tensor& weight,
                                             const torch::Tensor& bias);

/// Computes model::Op::kPositionCode.
[[nodiscard]] torch::Tensor add_position_code(const torch::Tensor& x);

}  // namespace e2lf::learn
