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

/// Returns the convolutions inside a recurrent layer, "gates" and, for a GRU, "candidate", with their numbers of
/// outputs.
std::vector<std::pair<std::string, int64_t>> cell_convolutions(const Layer& layer) {
  const auto out = static_cast<int64_t>(layer.out_channels);
  if (layer.op == Op::kConvLstm) return {{layer.name + ".gates", 4 * out}};
  return {{layer.name + ".gates", 2 * out}, {layer.name + ".candidate", out}};
}

/// Computes model::Op::kDynamicFilter.
torch::Tensor filter_pixels(const torch::Tensor& x, const torch::Tensor& filters, int64_t kernel) {
  const int64_t batch = x.size(0), channels = x.size(1), y = x.size(2), width = x.size(3), taps = kernel * kernel;
  const auto around = at::im2col(x, {kernel, kernel}, {1, 1}, {kernel / 2, kernel / 2}, {1, 1})
                          .reshape({batch, channels, taps, y, width});
  return torch::einsum("bmtyx,bctyx->bmcyx", {filters.reshape({batch, -1, taps, y, width}), around})
      .reshape({batch, -1, y, width});
}

/// Computes one frame of a recurrent layer; see model::Op.
torch::Tensor run_cell(const Layer& layer, const torch::Tensor& x, const NamedTensors& weights, NamedTensors& state) {
  const auto convolution = [&](const std::string& part, const torch::Tensor& input) {
    const std::string name = layer.name + part;
    return at::conv2d(input, weights.at(name + ".weight").to(x.scalar_type()),
                      weights.at(name + ".bias").to(x.scalar_type()), 1, static_cast<int64_t>(layer.kernel / 2));
  };
  const auto remembered = [&](const std::string& name) -> torch::Tensor& {
    torch::Tensor& tensor = state[name];
    const auto channels = static_cast<int64_t>(layer.out_channels);
    if (!tensor.defined()) tensor = torch::zeros({x.size(0), channels, x.size(2), x.size(3)}, x.options());
    return tensor;
  };
  torch::Tensor& hidden = remembered(layer.name);
  if (layer.op == Op::kConvLstm) {
    torch::Tensor& memory = remembered(layer.name + ".memory");
    const auto gates = convolution(".gates", torch::cat({x, hidden}, 1)).chunk(4, 1);
    memory = torch::sigmoid(gates[1]) * memory + torch::sigmoid(gates[0]) * torch::tanh(gates[3]);
    return hidden = torch::sigmoid(gates[2]) * torch::tanh(memory);
  }
  const auto gates = torch::sigmoid(convolution(".gates", torch::cat({x, hidden}, 1))).chunk(2, 1);
  const auto candidate = torch::tanh(convolution(".candidate", torch::cat({x, gates[1] * hidden}, 1)));
  return hidden = hidden * (1.0 - gates[0]) + candidate * gates[0];
}

}  // namespace

NetworkModule::NetworkModule(model::Network network, torch::Device device) : network_(std::move(network)) {
  const std::vector<model::LayerShape> shapes = model::infer_shapes(network_).value();
  std::map<std::string, size_t> channels = {{"input", network_.input_channels}};
  for (size_t i = 0; i < shapes.size(); ++i) {
    const Layer& layer = network_.layers[i];
    channels[layer.name] = shapes[i].channels;
    const auto in = static_cast<int64_t>(layer.inputs.empty() ? 0 : channels.at(layer.inputs.front()));
    if (model::is_cell(layer)) {
      const int64_t depth = in + static_cast<int64_t>(layer.out_channels);
      const auto size = static_cast<int64_t>(layer.kernel);
      for (const auto& [name, outputs] : cell_convolutions(layer)) {
        const double scale = 1.0 / std::sqrt(static_cast<double>(depth * size * size));
        parameters_[name + ".weight"] =
            (torch::randn({outputs, depth, size, size}) * scale).to(device).set_requires_grad(true);
        parameters_[name + ".bias"] = torch::zeros({outputs}, torch::device(device)).set_requires_grad(true);
      }
      continue;
    }
    if (layer.op == Op::kLayerNorm) {
      parameters_[layer.name + ".weight"] = torch::ones({in}, torch::device(device)).set_requires_grad(true);
      parameters_[layer.name + ".bias"] = torch::zeros({in}, torch::device(device)).set_requires_grad(true);
    }
    if (layer.op != Op::kConv && layer.op != Op::kConvTransposed) continue;

    const auto out = static_cast<int64_t>(layer.out_channels), kernel = static_cast<int64_t>(layer.kernel);
    const bool transposed = layer.op == Op::kConvTransposed;
    const double fan_in = static_cast<double>(transposed ? in : in * kernel * kernel);
    auto weight = torch::randn({transposed ? in : out, transposed ? out : in, kernel, kernel}) *
                  std::sqrt((layer.relu ? 2.0 : 1.0) / fan_in);
    if (!layer.residual.empty()) weight.zero_();
    // Stored as our kernels read it and return its gradient: [kernel, kernel, in, out].
    if (device.is_cpu() && layer.op == Op::kConv && kernel == 3)
      weight = weight.permute({2, 3, 1, 0}).contiguous().permute({3, 2, 0, 1});
    parameters_[layer.name + ".weight"] = weight.to(device).set_requires_grad(true);
    parameters_[layer.name + ".bias"] = torch::zeros({out}, torch::device(device)).set_requires_grad(true);
  }
}

torch::Tensor NetworkModule::forward(const torch::Tensor& input, torch::ScalarType compute, const NamedTensors& weights,
                                     NamedTensors* input_means) const {
  NamedTensors at_rest;
  return forward(input, compute, weights, input_means, at_rest);
}

torch::Tensor NetworkModule::forward(const torch::Tensor& input, torch::ScalarType compute, const NamedTensors& weights,
                                     NamedTensors* input_means, NamedTensors& state) const {
  std::map<std::string, torch::Tensor> values = {
      {"input", input.to(compute).contiguous(at::MemoryFormat::ChannelsLast)}};
  torch::Tensor x;
  for (const Layer& layer : network_.layers) {
    x = layer.inputs.empty() ? torch::Tensor() : values.at(layer.inputs.front());
    const auto stride = static_cast<int64_t>(layer.stride);
    if (input_means != nullptr && layer.op == Op::kConv) {
      (*input_means)[layer.name] = x.detach().mean({0, 2, 3}).to(torch::kFloat);
    }
    switch (layer.op) {
      case Op::kConv:
      case Op::kConvTransposed:
        x = convolve(layer, x, weights.at(layer.name + ".weight").to(compute),
                     weights.at(layer.name + ".bias").to(compute),
                     layer.residual.empty() ? torch::Tensor() : values.at(layer.residual));
        break;
      case Op::kPixelUnshuffle:
        x = unshuffle(x, stride);
        break;
      case Op::kPixelShuffle:
        x = shuffle(x, stride);
        break;
      case Op::kUpsample:
        x = x.repeat_interleave(stride, 2).repeat_interleave(stride, 3);
        break;
      case Op::kUpsampleBilinear:
        x = at::upsample_bilinear2d(x, {x.size(2) * stride, x.size(3) * stride}, false);
        break;
      case Op::kSigmoid:
        x = torch::sigmoid(x);
        break;
      case Op::kTanh:
        x = torch::tanh(x);
        break;
      case Op::kDynamicFilter:
        x = filter_pixels(x, values.at(layer.inputs[1]), static_cast<int64_t>(layer.kernel));
        break;
      case Op::kPrevious: {
        const auto channels = static_cast<int64_t>(layer.out_channels);
        torch::Tensor& last = state[layer.name];
        if (!last.defined())
          last = values.at("input").new_zeros({input.size(0), channels, input.size(2), input.size(3)});
        x = last;
        break;
      }
      case Op::kConvGru:
      case Op::kConvLstm:
        x = run_cell(layer, x, weights, state);
        break;
      case Op::kAdd:
      case Op::kMean:
        for (size_t i = 1; i < layer.inputs.size(); ++i) x = x + values.at(layer.inputs[i]);
        if (layer.op == Op::kMean) x = x / static_cast<double>(layer.inputs.size());
        break;
      case Op::kLayerNorm:
        x = normalise_pixels(x, weights.at(layer.name + ".weight").to(compute),
                             weights.at(layer.name + ".bias").to(compute));
        break;
      case Op::kPositionCode:
        x = add_position_code(x);
        break;
      case Op::kAttention:
        x = attend(x, values.at(layer.inputs[1]), values.at(layer.inputs[2]), static_cast<int64_t>(layer.heads));
        break;
      case Op::kConcat: {
        std::vector<torch::Tensor> parts;
        for (const std::string& name : layer.inputs) parts.push_back(values.at(name));
        x = torch::cat(parts, 1);
        break;
      }
    }
    const bool done = layer.op == Op::kConv || layer.op == Op::kConvTransposed;
    if (!done && !layer.residual.empty()) x = x + values.at(layer.residual);
    if (!done && layer.relu) x = torch::relu(x);
    values[layer.name] = x;
  }
  for (const Layer& layer : network_.layers) {
    if (layer.op == Op::kPrevious) state[layer.name] = x;
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
