// SPDX-License-Identifier: MIT
#pragma once

#include <torch/torch.h>

namespace e2lf::learn {

/// A 3x3 convolution of stride 1 with a border of zeros, its bias, an optional residual (undefined: none) added, then
/// ReLU if asked for; with gradients. Winograd's method (see winograd_conv.h), float32 on the CPU, on torch's threads.
/// x [b, in, y, x], weight [out, in, 3, 3], bias [out], residual and result [b, out, y, x], channels last inside.
/// A residual and ReLU together are not supported: the gradient of the residual would need the mask of the ReLU.
[[nodiscard]] torch::Tensor conv3x3(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias,
                                    const torch::Tensor& residual, bool relu);

}  // namespace e2lf::learn
