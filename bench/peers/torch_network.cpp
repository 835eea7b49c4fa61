// SPDX-License-Identifier: MIT
#include <chrono>
#include <cmath>
#include <cstring>
#include <string>
#include <torch/torch.h>
#include <vector>

#include "peers/torch_peer.h"

namespace {

struct Convolution {
  torch::Tensor weight, bias;
  int64_t stride = 1, padding = 0;

  Convolution() = default;
  Convolution(const float* w, const float* b, size_t out, size_t in, size_t kernel, size_t step)
      : weight(tensor_of(w, {as_int(out), as_int(in), as_int(kernel), as_int(kernel)})),
        bias(tensor_of(b, {as_int(out)})),
        stride(as_int(step)),
        padding(step == kernel ? 0 : as_int(kernel / 2)) {}

  static int64_t as_int(size_t value) { return static_cast<int64_t>(value); }
  static torch::Tensor tensor_of(const float* data, std::vector<int64_t> shape) {
    return torch::from_blob(const_cast<float*>(data), shape, torch::kFloat32);
  }

  torch::Tensor operator()(const torch::Tensor& x) const { return torch::conv2d(x, weight, bias, stride, padding); }
};

/// A layer with the state of its cell or with its position code.
struct Module {
  E2lfTorchLayer layer{};
  Convolution conv, candidate;
  torch::Tensor hidden, memory;

  explicit Module(const E2lfTorchLayer& of) : layer(of) {
    const bool is_cell = of.op == kE2lfGru || of.op == kE2lfLstm;
    const size_t in = is_cell ? of.in_channels + of.out_channels : of.in_channels;
    const size_t parts = of.op == kE2lfLstm ? 4 : of.op == kE2lfGru ? 2 : 1;
    if (of.op == kE2lfLayerNorm) {
      conv.weight = Convolution::tensor_of(of.weight, {Convolution::as_int(in)});
      conv.bias = Convolution::tensor_of(of.bias, {Convolution::as_int(in)});
    } else if (of.weight != nullptr) {
      conv = {of.weight, of.bias, parts * of.out_channels, in, of.kernel, of.stride};
    }
    if (of.op == kE2lfGru) candidate = {of.candidate_weight, of.candidate_bias, of.out_channels, in, of.kernel, 1};
  }

  torch::Tensor run_cell(const torch::Tensor& x) {
    if (!hidden.defined()) {
      const std::vector<int64_t> shape = {1, Convolution::as_int(layer.out_channels), x.size(2), x.size(3)};
      hidden = torch::zeros(shape);
      memory = torch::zeros(shape);
    }
    if (layer.op == kE2lfLstm) {
      const auto gates = conv(torch::cat({x, hidden}, 1)).chunk(4, 1);
      memory = torch::sigmoid(gates[1]) * memory + torch::sigmoid(gates[0]) * torch::tanh(gates[3]);
      return hidden = torch::sigmoid(gates[2]) * torch::tanh(memory);
    }
    const auto gates = torch::sigmoid(conv(torch::cat({x, hidden}, 1))).chunk(2, 1);
    const auto wanted = torch::tanh(candidate(torch::cat({x, gates[1] * hidden}, 1)));
    return hidden = hidden * (1 - gates[0]) + wanted * gates[0];
  }

  /// Computes the code only once, as the published program does.
  torch::Tensor position_code(const torch::Tensor& x) {
    if (hidden.defined()) return hidden;
    const auto pairs = torch::arange((x.size(1) + 1) / 2, torch::kDouble);
    const auto frequencies = torch::pow(10000.0, pairs * (-2.0 / static_cast<double>(x.size(1))));
    const auto angles = torch::outer(frequencies, torch::arange(x.size(2) * x.size(3), torch::kDouble));
    const auto code = torch::stack({torch::sin(angles), torch::cos(angles)}, 1).flatten(0, 1).slice(0, 0, x.size(1));
    return hidden = code.to(torch::kFloat32).reshape(x.sizes());
  }

  /// Computes the same products as torch's MultiheadAttention.
  torch::Tensor attend(const torch::Tensor& queries, const torch::Tensor& keys, const torch::Tensor& values) const {
    const auto heads = Convolution::as_int(layer.heads), size = queries.size(1) / heads;
    const auto parts = [&](const torch::Tensor& x) { return x.reshape({heads, size, -1}).transpose(1, 2); };
    const auto scaled = parts(queries) / std::sqrt(static_cast<double>(size));
    const auto shares = torch::softmax(torch::bmm(scaled, parts(keys).transpose(1, 2)), 2);
    return torch::bmm(shares, parts(values)).transpose(1, 2).reshape(values.sizes());
  }

  torch::Tensor run(const std::vector<torch::Tensor>& tensors) {
    const torch::Tensor& x = tensors[layer.inputs[0]];
    switch (layer.op) {
      case kE2lfGru:
      case kE2lfLstm:
        return run_cell(x);
      case kE2lfBilinear: {
        const auto step = Convolution::as_int(layer.stride);
        return torch::upsample_bilinear2d(x, {x.size(2) * step, x.size(3) * step}, /*align_corners=*/false);
      }
      case kE2lfAdd:
      case kE2lfMean: {
        torch::Tensor sum = x;
        for (size_t i = 1; i < layer.num_inputs; ++i) sum = sum + tensors[layer.inputs[i]];
        return layer.op == kE2lfAdd ? sum : sum / static_cast<double>(layer.num_inputs);
      }
      case kE2lfLayerNorm:
        return torch::layer_norm(x.permute({0, 2, 3, 1}), {x.size(1)}, conv.weight, conv.bias).permute({0, 3, 1, 2});
      case kE2lfPositionCode:
        return x + position_code(x);
      case kE2lfAttention:
        return attend(x, tensors[layer.inputs[1]], tensors[layer.inputs[2]]);
      case kE2lfSigmoid:
        return torch::sigmoid(x);
      case kE2lfConv:
        break;
    }
    torch::Tensor y = conv(x);
    if (layer.residual != 0) y = y.add_(tensors[layer.residual - 1]);
    return layer.relu != 0 ? torch::relu_(y) : y;
  }
};

}  // namespace

const char* e2lf_torch_network(const E2lfTorchNetworkJob* job) {
  static std::string message;
  try {
    const torch::InferenceMode guard;
    torch::set_num_threads(job->threads);
    std::vector<Module> modules;
    for (size_t i = 0; i < job->num_layers; ++i) modules.emplace_back(job->layers[i]);
    const auto input = Convolution::tensor_of(
        job->input,
        {1, Convolution::as_int(job->in_channels), Convolution::as_int(job->height), Convolution::as_int(job->width)});
    std::vector<size_t> last(job->num_layers + 1, job->num_layers);  // which layer is the last to read a tensor
    for (size_t i = 0; i < job->num_layers; ++i) {
      const E2lfTorchLayer& layer = job->layers[i];
      for (size_t k = 0; k < layer.num_inputs; ++k) last[layer.inputs[k]] = i;
      if (layer.residual != 0) last[layer.residual - 1] = i;
    }
    for (size_t run = 0; run < job->runs; ++run) {
      const auto begin = std::chrono::steady_clock::now();
      std::vector<torch::Tensor> tensors = {input};
      for (size_t i = 0; i < modules.size(); ++i) {
        tensors.push_back(modules[i].run(tensors));
        for (size_t k = 0; k <= i; ++k) {
          if (last[k] == i) tensors[k].reset();
        }
      }
      const torch::Tensor output = tensors.back().contiguous();
      job->seconds[run] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      std::memcpy(job->output, output.data_ptr<float>(), output.nbytes());
    }
    return nullptr;
  } catch (const std::exception& error) {
    message = error.what();
    return message.c_str();
  }
}

const char* e2lf_torch_version() {
  return TORCH_VERSION;
}
