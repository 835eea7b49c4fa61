// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/network_module.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "e2lf/base/text.h"
#if E2LF_LEARN_KERNELS
#include "e2lf/geometry/operations.h"
#endif

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

/// Returns whether a layer reads the input, or its unshuffled pixels.
bool reads_input(const model::Network& network, const Layer& layer) {
  const auto is_unshuffled_input = [&](const std::string& name) {
    return std::any_of(network.layers.begin(), network.layers.end(), [&](const Layer& other) {
      return other.name == name && other.op == Op::kPixelUnshuffle && other.inputs.front() == "input";
    });
  };
  return layer.op == Op::kConv && (layer.inputs.front() == "input" || is_unshuffled_input(layer.inputs.front()));
}

bool on_cpu_in_float(const torch::Tensor& x) {
  return x.is_cpu() && x.scalar_type() == torch::kFloat;
}

/// Computes a 1x1 convolution without bias. For channels-last tensors it is one matrix product, which libraries compute
/// fastest.
torch::Tensor pointwise(const torch::Tensor& x, const torch::Tensor& weight) {
  if (!on_cpu_in_float(x)) return at::conv2d(x, weight.reshape({weight.size(0), weight.size(1), 1, 1}));
  return torch::matmul(x.permute({0, 2, 3, 1}), weight.t()).permute({0, 3, 1, 2});
}

torch::Tensor finish(const Layer& layer, torch::Tensor x, const torch::Tensor& bias, const torch::Tensor& residual) {
  x = x + bias.reshape({1, -1, 1, 1});
  if (residual.defined()) x = x + residual;
  return layer.relu ? torch::relu(x) : x;
}

/// Places windows [b, y, x, window y, window x, c] side by side: [b, c, y, x].
torch::Tensor lay_out(const torch::Tensor& windows) {
  const auto b = windows.size(0), h = windows.size(1), w = windows.size(2), s = windows.size(3), c = windows.size(5);
  return windows.permute({0, 1, 3, 2, 4, 5}).reshape({b, h * s, w * s, c}).permute({0, 3, 1, 2});
}

/// Computes a convolution whose windows do not overlap as a matrix product over the channels of each window.
torch::Tensor convolve_windows(const Layer& layer, const torch::Tensor& input, const torch::Tensor& weight) {
  const auto stride = static_cast<int64_t>(layer.stride);
  if (layer.op == Op::kConvTransposed) {
    const auto result = pointwise(input, weight.permute({2, 3, 1, 0}).reshape({-1, weight.size(0)}));
    // Channels last in the windows, too, so that whole pixels are copied.
    return lay_out(result.permute({0, 2, 3, 1})
                       .reshape({input.size(0), input.size(2), input.size(3), stride, stride, weight.size(1)}));
  }
  return pointwise(stride == 1 ? input : unshuffle(input, stride), weight.reshape({weight.size(0), -1}));
}

torch::Tensor convolve_plainly(const Layer& layer, const torch::Tensor& input, const torch::Tensor& weight,
                               const torch::Tensor& bias) {
  // oneDNN is slow with channels last on CPUs without AVX-512.
  const auto x = on_cpu_in_float(input) ? input.contiguous() : input;
  const auto padding = static_cast<int64_t>(layer.stride == layer.kernel ? 0 : layer.kernel / 2);
  return at::conv2d(x, weight, bias, static_cast<int64_t>(layer.stride), padding);
}

torch::Tensor sum(const TorchCall& call) {
  torch::Tensor total = call.inputs.front();
  for (size_t i = 1; i < call.inputs.size(); ++i) total = total + call.inputs[i];
  return total;
}

/// The operations of this process.
struct Registry {
  std::mutex mutex;
  std::map<std::string, TorchOperation> operations = {
      {Op::kPixelUnshuffle, [](const TorchCall& call) { return unshuffle(call.inputs[0], stride_of(call)); }},
      {Op::kPixelShuffle, [](const TorchCall& call) { return shuffle(call.inputs[0], stride_of(call)); }},
      {Op::kUpsample,
       [](const TorchCall& call) {
         return call.inputs[0].repeat_interleave(stride_of(call), 2).repeat_interleave(stride_of(call), 3);
       }},
      {Op::kAdd, sum},
      {Op::kMean, [](const TorchCall& call) { return sum(call) / static_cast<double>(call.inputs.size()); }},
#if E2LF_LEARN_KERNELS
      {geometry::GeometryOp::kPlaneSweep, apply_plane_sweep},
      {geometry::GeometryOp::kRenderLayers, apply_render_layers},
      {geometry::GeometryOp::kWarp, apply_warp},
#endif
      {Op::kConcat, [](const TorchCall& call) { return torch::cat(call.inputs, 1); }},
      {Op::kSigmoid, [](const TorchCall& call) { return torch::sigmoid(call.inputs[0]); }}};

 private:
  static int64_t stride_of(const TorchCall& call) {
    return static_cast<int64_t>(call.layer.stride);
  }
};

Registry& registry() {
  static Registry instance;
  return instance;
}

}  // namespace

NetworkModule::NetworkModule(model::Network network, torch::Device device, const Shapes& others)
    : network_(std::move(network)) {
  for (model::WeightShape tensor : model::weight_shapes(network_)) {
    if (const auto other = others.find(tensor.name); other != others.end()) tensor.shape = other->second;
    const Layer& layer = network_.layers[tensor.layer];
    torch::Tensor weight = initial_weight(layer, tensor);
    // Stored as our kernels read it and return its gradient: [kernel, kernel, in, out].
    if (device.is_cpu() && layer.op == Op::kConv && layer.kernel == 3 && weight.dim() == 4)
      weight = weight.permute({2, 3, 1, 0}).contiguous().permute({3, 2, 0, 1});
    parameters_[tensor.name] = weight.to(device).set_requires_grad(true);
  }
}

torch::Tensor NetworkModule::forward(const torch::Tensor& input, torch::ScalarType compute, const NamedTensors* weights,
                                     NamedTensors* input_means, const NamedTensors& given) const {
  if (weights == nullptr) weights = &parameters_;
  std::map<std::string, torch::Tensor> values = {
      {"input", input.to(compute).contiguous(at::MemoryFormat::ChannelsLast)}};
  for (const auto& [name, output] : given) values[name] = output.contiguous(at::MemoryFormat::ChannelsLast);
  torch::Tensor x;
  for (const Layer& layer : network_.layers) {
    if (given.contains(layer.name)) continue;
    const auto weight = [&](const std::string& part) { return weights->at(layer.name + part).to(compute); };
    if (layer.op == Op::kConv || layer.op == Op::kConvTransposed) {
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

model::Weights widen_inputs(const model::Network& network, model::Weights weights, const model::Network& wider,
                            const std::vector<InputOrigin>& origins) {
  E2LF_REQUIRE(origins.size() == wider.input_channels, "each input channel needs an origin");
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
      return fail(ErrorCode::kNotFound, location, "no weights for \"", name, "\"; the file is for another network");
    }
    if (static_cast<int64_t>(found->second.size()) != tensor.numel()) {
      return fail(ErrorCode::kShape, location, "\"", name, "\" has ", found->second.size(), " values instead of ",
                  tensor.numel(), "; the file is for another network");
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

torch::Tensor convolve(const Layer& layer, const torch::Tensor& input, const torch::Tensor& weight,
                       const torch::Tensor& bias, const torch::Tensor& residual) {
  torch::Tensor result;
  if (layer.op == Op::kConvTransposed || (layer.kernel == layer.stride && on_cpu_in_float(input))) {
    result = finish(layer, convolve_windows(layer, input, weight), bias, residual);
  } else {
#if E2LF_LEARN_KERNELS
    if (on_cpu_in_float(input) && layer.kernel == 3 && layer.stride == 1) {
      const bool fused = !(residual.defined() && layer.relu);
      if (fused) return conv3x3(input, weight, bias, residual, layer.relu);
      return torch::relu(conv3x3(input, weight, bias, residual, false));
    }
#endif
    result = convolve_plainly(layer, input, weight, bias);
    if (residual.defined()) result = result + residual;
    if (layer.relu) result = torch::relu(result);
  }
  return result.contiguous(at::MemoryFormat::ChannelsLast);
}

torch::Tensor shuffle(const torch::Tensor& x, int64_t s) {
  const auto b = x.size(0), c = x.size(1) / (s * s), h = x.size(2), w = x.size(3);
  return lay_out(x.permute({0, 2, 3, 1}).reshape({b, h, w, c, s, s}).permute({0, 1, 2, 4, 5, 3}));
}

torch::Tensor unshuffle(const torch::Tensor& x, int64_t s) {
  const auto b = x.size(0), c = x.size(1), h = x.size(2) / s, w = x.size(3) / s;
  const auto pixels = x.permute({0, 2, 3, 1}).reshape({b, h, s, w, s, c}).permute({0, 1, 3, 5, 2, 4});
  return pixels.reshape({b, h, w, c * s * s}).permute({0, 3, 1, 2});
}

void add_operation(const std::string& name, TorchOperation operation) {
  const std::scoped_lock lock(registry().mutex);
  E2LF_REQUIRE(registry().operations.emplace(name, operation).second,
               cat("an operation \"", name, "\" already exists"));
}

bool has_operation(const std::string& name) {
  const std::scoped_lock lock(registry().mutex);
  return name == Op::kConv || name == Op::kConvTransposed || registry().operations.contains(name);
}

TorchOperation find_operation(const std::string& name) {
  const std::scoped_lock lock(registry().mutex);
  const auto found = registry().operations.find(name);
  E2LF_REQUIRE(found != registry().operations.end(), cat("the operation ", name, " cannot be trained"));
  return found->second;
}

}  // namespace e2lf::learn
