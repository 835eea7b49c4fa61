// SPDX-License-Identifier: MIT
#pragma once

#include <torch/torch.h>

namespace e2lf::learn {

/// Computes a 3x3 convolution with stride 1 and zero padding, adds the bias and an optional residual (none if
/// undefined), and applies ReLU if `relu`. Differentiable. Uses Winograd's method (see winograd_conv.h) in float32 on
/// the CPU, on torch's threads. x is [b, in, y, x], weight [out, in, 3, 3], bias [out], residual and result [b, out, y,
/// x]; images are channels-last. A residual together with ReLU is not supported, because the gradient of the residual
/// would need the mask of the ReLU.
[[nodiscard]] torch::Tensor conv3x3(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias,
                                    const torch::Tensor& residual, bool relu);

}  // namespace e2lf::learn
