// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <torch/types.h>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/model.h"

namespace e2lf::learn {

/// Named float32 tensors in a fixed order: what is optimised, averaged and checkpointed.
using NamedTensors = std::map<std::string, torch::Tensor>;

/// A network description as differentiable torch operations: the same layers, names and weight layouts as in `engine`.
class NetworkModule {
 public:
  /// Weights are drawn from torch's generator: He's normal distribution, zero biases; a convolution with a residual
  /// input starts at zero, so that every residual block starts as the identity. The description must be valid.
  NetworkModule(model::Network network, torch::Device device);

  /// input: float32 [batch, input_channels, y, x], y and x multiples of model::size_multiple(). Returns float32
  /// [batch, output_channels, y, x]. Convolutions run in `compute` (kFloat or kBFloat16), channels last, with the
  /// float32 master weights cast on the way, so that gradients are float32.
  [[nodiscard]] torch::Tensor forward(const torch::Tensor& input, torch::ScalarType compute) const {
    return forward(input, compute, parameters_);
  }

  /// The same with other weights of the same names and shapes, e.g. their moving average. `input_means`, where given,
  /// gets the mean [in] over pixels and batch of what goes into each convolution (transposed ones left out), by layer.
  [[nodiscard]] torch::Tensor forward(const torch::Tensor& input, torch::ScalarType compute,
                                      const NamedTensors& weights, NamedTensors* input_means = nullptr) const;

  /// The same of a recurrent network, with a state that goes from frame to frame: what each cell remembers, by the
  /// layer's name, and "<layer>.memory" of kConvLstm; the last output by the name of kPrevious. Empty: at rest, where
  /// forward() begins each time.
  [[nodiscard]] torch::Tensor forward_frame(const torch::Tensor& input, torch::ScalarType compute,
                                            NamedTensors& state) const {
    return forward(input, compute, parameters_, nullptr, state);
  }

  /// "<layer>.weight", "<layer>.bias": leaves that require gradients.
  [[nodiscard]] const NamedTensors& parameters() const { return parameters_; }
  [[nodiscard]] const model::Network& network() const { return network_; }

 private:
  [[nodiscard]] torch::Tensor forward(const torch::Tensor& input, torch::ScalarType compute,
                                      const NamedTensors& weights, NamedTensors* input_means,
                                      NamedTensors& state) const;
  model::Network network_;
  NamedTensors parameters_;
};

/// Which channel of a network's input another network's channel continues, if any, and by what its weights are
/// multiplied.
struct InputOrigin {
  std::optional<size_t> channel = std::nullopt;
  float factor = 1.0F;
};

/// The weights of a network for another that differs in its input channels alone: the layers that read the input, or
/// its pixels unshuffled, get the weights of each channel's origin, zeros where it has none. Weights of networks with
/// other layers are returned as they are.
[[nodiscard]] model::Weights widen_inputs(const model::Network& network, model::Weights weights,
                                          const model::Network& wider, const std::vector<InputOrigin>& origins);

/// Copies values into tensors of the same names. Fails with kNotFound and kShape, naming the tensor in `location`.
[[nodiscard]] Result<void> load_weights(const NamedTensors& parameters, const model::Weights& weights,
                                        const std::string& location);

/// The values as plain vectors, as a model file holds them.
[[nodiscard]] model::Weights to_weights(const NamedTensors& parameters);

}  // namespace e2lf::learn
