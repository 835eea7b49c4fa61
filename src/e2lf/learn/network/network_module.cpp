// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/network_module.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "e2lf/base/contract.h"
#include "e2lf/learn/network/operations.h"

namespace e2lf::learn {
namespace {

using model::Layer;
using model::Op;

/// Returns initial weights of a tensor of a layer: He's normal distribution, zero for biases, one for other scales.
torch::Tensor initial_weight(const Layer& layer, const model::WeightShape& tensor) {
  const std::vector<int64_t> shape(tensor.shape.begin(), tensor.shape.end());
  if (shape.size() == 1) return tensor.name.ends_with(".bias") ? torch::zeros(shape) : torch::ones(shape);
  const bool transposed = layer.op == Op::kConvTransposed;
  const size_t fan_in = transposed ? tensor.shape[0] : tensor.size() / tensor.shape[0];
  auto weight = torch::randn(shape) * std::sqrt((layer.relu ? 2.0 : 1.0) / static_cast<double>(fan_in));
  return layer.residual.empty() ? weight : weight.zero_();
}

}  // namespace

NetworkModule::NetworkModule(model::Network network, torch::Device device) : network_(std::move(network)) {
  for (const model::WeightShape& tensor : model::weight_shapes(network_)) {
    const Layer& layer = network_.layers[tensor.layer];
    torch::Tensor weight = initial_weight(layer, tensor);
    // Stored as our kernels read it and return its gradient: [kernel, kernel, in, out].
    if (device.is_cpu() && layer.op == Op::kConv && layer.kernel == 3 && weight.dim() == 4)
      weight = weight.permute({2, 3, 1, 0}).contiguous().permute({3, 2, 0, 1});
    parameters_[tensor.name] = weight.to(device).set_requires_grad(true);
  }
}

torch::Tensor NetworkModule::forward(const torch::Tensor& input, torch::ScalarType compute, const NamedTensors& weights,
                                     NamedTensors* input_means) const {
  std::map<std::string, torch::Tensor> values = {
      {"input", input.to(compute).contiguous(at::MemoryFormat::ChannelsLast)}};
  torch::Tensor x;
  for (const Layer& layer : network_.layers) {
    const auto weight = [&](const std::string& part) { return weights.at(layer.name + part).to(compute); };
    if (is_convolution(layer)) {
      const torch::Tensor& from = values.at(layer.inputs.front());
      if (input_means != nullptr && layer.op == Op::kConv) {
        (*input_means)[layer.name] = from.detach().mean({0, 2, 3}).to(torch::kFloat);
      }
      const auto residual = layer.residual.empty() ? torch::Tensor() : values.at(layer.residual);
      x = convolve(layer, from, weight(".weight"), weight(".bias"), residual);
    } else {
      TorchCall call{layer, {}, weight};
      for (const std::string& name : layer.inputs) call.inputs.push_back(values.at(name));
      x = find_operation(layer.op)(call);
      if (layer.relu) x = torch::relu(x);
    }
    values[layer.name] = x;
  }
  return x.to(input.scalar_type());
}

namespace {

/// Returns whether a layer reads the input, or its unshuffled pixels.
bool reads_input(const model::Network& network, const Layer& layer) {
  const auto is_unshuffled_input = [&](const std::string& name) {
    return std::any_of(network.layers.begin(), network.layers.end(), [&](const Layer& other) {
      return other.name == name && other.op == Op::kPixelUnshuffle && other.inputs.front() == "input";
    });
  };
  return layer.op == Op::kConv && (layer.inputs.front() == "input" || is_unshuffled_input(layer.inputs.front()));
}

}  // namespace

model::Weights widen_inputs(const model::Network& network, model::Weights weights, const model::Network& wider,
                            const std::vector<InputOrigin>& origins) {
  E2LF_REQUIRE(origins.size() == wider.input_channels, "one origin for each input channel");
  if (network.layers != wider.layers) return weights;
  for (const Layer& layer : network.layers) {
    // [out, in, kernel, kernel], where `in` runs over the input channels, or over the pixels unshuffled from each of
    // them.
    const auto found = weights.find(layer.name + ".weight");
    const size_t outputs = layer.out_channels;
    if (!reads_input(network, layer) || found == weights.end()) continue;
    const size_t block = found->second.size() / outputs / network.input_channels;
    std::vector<float> values(outputs * wider.input_channels * block);
    for (size_t out = 0; out < outputs; ++out) {
      for (size_t channel = 0; channel < wider.input_channels; ++channel) {
        const InputOrigin& origin = origins[channel];
        if (!origin.channel) continue;
        const float* from = &found->second[(out * network.input_channels + *origin.channel) * block];
        float* to = &values[(out * wider.input_channels + channel) * block];
        std::transform(from, from + block, to, [&](float weight) { return weight * origin.factor; });
      }
    }
    found->second = std::move(values);
  }
  return weights;
}

Result<void> load_weights(const NamedTensors& parameters, const model::Weights& weights, const std::string& location) {
  torch::NoGradGuard no_grad;
  for (const auto& [name, tensor] : parameters) {
    const auto found = weights.find(name);
    if (found == weights.end()) {
      return Error{ErrorCode::kNotFound, cat("no weights for \"", name, "\"; the file is for another network"),
                   location};
    }
    if (static_cast<int64_t>(found->second.size()) != tensor.numel()) {
      return Error{ErrorCode::kShape,
                   cat("\"", name, "\" has ", found->second.size(), " values instead of ", tensor.numel(),
                       "; the file is for another network"),
                   location};
    }
    auto target = tensor;
    target.copy_(torch::tensor(at::ArrayRef<float>(found->second)).reshape(tensor.sizes()));
  }
  return {};
}

model::Weights to_weights(const NamedTensors& parameters) {
  model::Weights weights;
  for (const auto& [name, tensor] : parameters) {
    const auto values = tensor.detach().to(torch::kCPU, torch::kFloat).contiguous();
    const float* data = values.data_ptr<float>();
    weights[name].assign(data, data + values.numel());
  }
  return weights;
}

}  // namespace e2lf::learn
