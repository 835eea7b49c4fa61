// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <torch/torch.h>
#include <vector>

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

/// A layer to be applied to tensors [batch, channel, y, x] in the type of the computation.
struct TorchCall {
  const model::Layer& layer;
  std::vector<torch::Tensor> inputs;

  /// Returns the weights "<layer><part>", e.g. of ".weight", in the same type.
  std::function<torch::Tensor(const std::string& part)> weight;
};

/// Computes the output of a layer, without ReLU.
using TorchOperation = torch::Tensor (*)(const TorchCall& call);

/// Makes an operation that was added to model::Operation known to training. A name that is taken breaks the contract.
void add_operation(const std::string& name, TorchOperation operation);

/// Returns true for convolutions and transposed ones, which convolve() computes.
[[nodiscard]] bool is_convolution(const model::Layer& layer);

/// Returns the function of an operation other than these. A name that is unknown breaks the contract.
[[nodiscard]] TorchOperation find_operation(const std::string& name);

}  // namespace e2lf::learn
