// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/engine/kernel.h"

/// Kernels that only networks for frames use; those of recurrent cells are in cells.h.
namespace e2lf::engine {

/// Makes the kernel of model::Op::kAttention. Its inputs are q, k and v [channels], of the same type as the output. The
/// keys are processed in blocks with a running softmax, so that a thread needs memory for only a few queries and keys
/// at any image size.
[[nodiscard]] std::unique_ptr<Kernel> make_attention(size_t channels, size_t heads, ElementType type);

/// Makes the kernel of model::Op::kUpsampleBilinear by `stride`, whose input and output have the same type. `relu` is
/// as in model::Layer.
[[nodiscard]] std::unique_ptr<Kernel> make_bilinear(size_t channels, size_t stride, bool relu, ElementType type);

/// Makes the kernel of model::Op::kDynamicFilter. Its inputs are x [channels] and f [filter_values], of the same type
/// as the output.
[[nodiscard]] std::unique_ptr<Kernel> make_dynamic_filter(size_t channels, size_t filter_values, size_t kernel,
                                                          ElementType type);

/// Makes the kernel of model::Op::kLayerNorm, whose input and output have the same type. `weight` and `bias` have one
/// value per channel.
[[nodiscard]] std::unique_ptr<Kernel> make_layer_norm(const std::vector<float>& weight, const std::vector<float>& bias,
                                                      ElementType type);

/// Makes the kernel of model::Op::kPositionCode, whose input and output have the same type.
[[nodiscard]] std::unique_ptr<Kernel> make_position_code(size_t channels, ElementType type);

}  // namespace e2lf::engine
