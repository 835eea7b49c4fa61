// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>

namespace e2lf::learn {

/// Computes model::Op::kAttention on tensors [batch, channel, y, x].
[[nodiscard]] torch::Tensor attend(const torch::Tensor& queries, const torch::Tensor& keys, const torch::Tensor& values,
                                   int64_t heads);

/// Computes model::Op::kLayerNorm; `weight` and `bias` are [channel].
[[nodiscard]] torch::Tensor normalise_pixels(const torch::Tensor& x, const torch::Tensor& weight,
                                             const torch::Tensor& bias);

/// Computes model::Op::kPositionCode.
[[nodiscard]] torch::Tensor add_position_code(const torch::Tensor& x);

}  // namespace e2lf::learn
