// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/operations.h"

#include <map>
#include <mutex>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#if E2LF_LEARN_KERNELS
#include "e2lf/learn/kernels/conv3x3.h"
#endif

namespace e2lf::learn {
namespace {

using model::Layer;
using model::Op;

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
      {Op::kConcat, [](const TorchCall& call) { return torch::cat(call.inputs, 1); }},
      {Op::kSigmoid, [](const TorchCall& call) { return torch::sigmoid(call.inputs[0]); }}};

 private:
  static int64_t stride_of(const TorchCall& call) { return static_cast<int64_t>(call.layer.stride); }
};

Registry& registry() {
  static Registry instance;
  return instance;
}

}  // namespace

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

bool is_convolution(const Layer& layer) {
  return layer.op == Op::kConv || layer.op == Op::kConvTransposed;
}

void add_operation(const std::string& name, TorchOperation operation) {
  const std::scoped_lock lock(registry().mutex);
  E2LF_REQUIRE(registry().operations.emplace(name, operation).second, cat("there is an operation \"", name, "\""));
}

TorchOperation find_operation(const std::string& name) {
  const std::scoped_lock lock(registry().mutex);
  const auto found = registry().operations.find(name);
  E2LF_REQUIRE(found != registry().operations.end(), cat("the operation ", name, " cannot be trained"));
  return found->second;
}

}  // namespace e2lf::learn
