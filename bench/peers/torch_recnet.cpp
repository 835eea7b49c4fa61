// SPDX-License-Identifier: MIT
#include "peers/torch_recnet.h"

#include <chrono>
#include <cstring>
#include <string>
#include <torch/torch.h>
#include <vector>

namespace {

constexpr size_t kLinearLayers = 3;

struct Layer {
  torch::Tensor weight, bias;
  int64_t padding = 0;
};

torch::Tensor tensor_of(const float* data, std::vector<int64_t> shape) {
  return torch::from_blob(const_cast<float*>(data), shape, torch::kFloat32);
}

std::vector<Layer> make_layers(const E2lfRecnetJob& job) {
  std::vector<Layer> layers;
  auto in = static_cast<int64_t>(job.in_channels);
  for (size_t i = 0; i < job.num_layers; ++i) {
    const auto out = static_cast<int64_t>(job.out_channels[i]);
    const auto kernel = static_cast<int64_t>(job.kernels[i]);
    layers.push_back(
        {tensor_of(job.weights[i], {out, in, kernel, kernel}), tensor_of(job.biases[i], {out}), kernel / 2});
    in = out;
  }
  return layers;
}

torch::Tensor forward(const std::vector<Layer>& layers, torch::Tensor x) {
  torch::Tensor skip;
  for (size_t i = 0; i < layers.size(); ++i) {
    x = torch::conv2d(x, layers[i].weight, layers[i].bias, 1, layers[i].padding);
    if (i + 1 == kLinearLayers) skip = x;
    if (i >= kLinearLayers && i + 1 < layers.size()) x = torch::relu_(x);
  }
  return x + skip;
}

}  // namespace

const char* e2lf_torch_recnet(const E2lfRecnetJob* job) {
  static std::string message;
  try {
    const torch::InferenceMode guard;
    torch::set_num_threads(job->threads);
    const std::vector<Layer> layers = make_layers(*job);
    const torch::Tensor input =
        tensor_of(job->input, {1, static_cast<int64_t>(job->in_channels), static_cast<int64_t>(job->height),
                               static_cast<int64_t>(job->width)});
    for (size_t run = 0; run < job->runs; ++run) {
      const auto begin = std::chrono::steady_clock::now();
      const torch::Tensor output = forward(layers, input).contiguous();
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
