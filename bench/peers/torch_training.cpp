// SPDX-License-Identifier: MIT
#include <chrono>
#include <string>
#include <torch/torch.h>

#include "peers/torch_peer.h"

namespace {

/// The paper's AcqNet: four patterns, the first of which is black, and reference-aware events with both kinds of noise.
struct Acquisition : torch::nn::Module {
  torch::Tensor patterns = register_parameter("patterns", 0.1 * torch::randn({3, 64}));

  torch::Tensor forward(const torch::Tensor& light_field) {
    constexpr double kEps = 0.01, kTau = 0.3, kSigmaW = 0.175, kSigmaZ = 0.04;
    const auto codes = torch::cat({torch::zeros({1, 64}), torch::sigmoid(10.0 * patterns)});
    const auto intensities = torch::einsum("nv,bvyx->bnyx", {codes / 64.0, light_field});
    const auto log_intensity = torch::log(intensities + kEps);
    auto reference = log_intensity.select(1, 0);
    std::vector<torch::Tensor> events;
    for (int64_t n = 1; n < 4; ++n) {
      const auto now = log_intensity.select(1, n);
      const auto threshold = (kTau + kSigmaZ * torch::randn_like(now)).clamp_min(0.01);
      const auto steps = (now - reference + kSigmaW * torch::randn_like(now)) / threshold;
      events.push_back(steps + (steps.trunc() - steps).detach());
      reference = reference + kTau * events.back();
    }
    return torch::stack(events, 1) / 8.0;
  }
};

torch::nn::Conv2d conv(int64_t in, int64_t out, int64_t kernel) {
  return torch::nn::Conv2d(torch::nn::Conv2dOptions(in, out, kernel).padding(kernel / 2));
}

/// The paper's RecNet: three linear 5x5 convolutions, followed by twenty 3x3 ones whose result is added to theirs.
struct Reconstruction : torch::nn::Module {
  torch::nn::Sequential linear{conv(3, 17, 5), conv(17, 32, 5), conv(32, 64, 5)};
  torch::nn::Sequential deep;

  Reconstruction() {
    for (int i = 0; i < 19; ++i) {
      deep->push_back(conv(64, 64, 3));
      deep->push_back(torch::nn::ReLU());
    }
    deep->push_back(conv(64, 64, 3));
    register_module("linear", linear);
    register_module("deep", deep);
  }

  torch::Tensor forward(const torch::Tensor& events) {
    const auto first = linear->forward(events);
    return first + deep->forward(first);
  }
};

}  // namespace

const char* e2lf_torch_training(const E2lfTorchTraining* job) {
  static std::string message;
  try {
    torch::manual_seed(1);
    Acquisition acquisition;
    Reconstruction reconstruction;
    auto parameters = reconstruction.parameters();
    parameters.push_back(acquisition.patterns);
    torch::optim::Adam optimiser(parameters, torch::optim::AdamOptions(1e-4));
    const auto batch = static_cast<int64_t>(job->batch), patch = static_cast<int64_t>(job->patch);
    const auto light_field = torch::rand({batch, 64, patch, patch});
    for (size_t step = 0; step < job->steps; ++step) {
      const auto begin = std::chrono::steady_clock::now();
      optimiser.zero_grad();
      const auto events = acquisition.forward(light_field);
      torch::mse_loss(reconstruction.forward(events), light_field).backward();
      optimiser.step();
      job->seconds[step] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    return nullptr;
  } catch (const std::exception& error) {
    message = error.what();
    return message.c_str();
  }
}
