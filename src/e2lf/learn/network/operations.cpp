// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/operations.h"

#include <cmath>

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

torch::Tensor attend(const torch::Tensor& queries, const torch::Tensor& keys, const torch::Tensor& values,
                     int64_t heads) {
  // [batch, head, pixel, channel]
  const auto parts = [heads](const torch::Tensor& x) {
    return x.reshape({x.size(0), heads, x.size(1) / heads, x.size(2) * x.size(3)}).transpose(2, 3);
  };
  const auto scale = 1.0 / std::sqrt(static_cast<double>(queries.size(1) / heads));
  const auto scores = torch::matmul(parts(queries) * scale, parts(keys).transpose(2, 3));
  const auto sums = torch::matmul(torch::softmax(scores, 3), parts(values));
  return sums.transpose(2, 3).reshape(values.sizes());
}

torch::Tensor normalise_pixels(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias) {
  return at::layer_norm(x.permute({0, 2, 3, 1}), {x.size(1)}, weight, bias, 1e-5).permute({0, 3, 1, 2});
}

torch::Tensor add_position_code(const torch::Tensor& x) {
  const int64_t channels = x.size(1), pixels = x.size(2) * x.size(3);
  const auto options = torch::device(x.device()).dtype(torch::kDouble);
  const auto pairs = torch::arange((channels + 1) / 2, options);
  const auto angles =
      torch::outer(torch::pow(10000.0, pairs * (-2.0 / static_cast<double>(channels))), torch::arange(pixels, options));
  const auto code = torch::stack({torch::sin(angles), torch::cos(angles)}, 1).reshape({-1, x.size(2), x.size(3)});
  return x + code.slice(0, 0, channels).to(x.scalar_type());
}

}  // namespace e2lf::learn
