// SPDX-License-Identifier: MIT
#pragma once

#include <torch/torch.h>

#include "e2lf/model/network.h"

namespace e2lf::learn {

/// A convolution layer of a network, or a transposed one: bias, residual (undefined: none) and ReLU included, in the
/// way that is fastest for the device and type of `input` [b, c, y, x]; the result has its channels last.
[[nodiscard]] torch::Tensor convolve(const model::Layer& layer, const torch::Tensor& input, const torch::Tensor& weight,
                                     const torch::Tensor& bias, const torch::Tensor& residual);

/// Pixel shuffle, [b, c * s^2, y, x] -> [b, c, y * s, x * s], and back, by views and one copy that keeps channels last.
[[nodiscard]] torch::Tensor shuffle(const torch::Tensor& x, int64_t s);
[[nodiscard]] torch::Tensor unshuffle(const torch::Tensor& x, int64_t s);

}  // namespace e2lf::learn
