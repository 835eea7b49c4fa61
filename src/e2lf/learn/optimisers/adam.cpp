// SPDX-License-Identifier: MIT
// Implements Adam of optimisers.h.
#include <cmath>

#include "e2lf/learn/optimisers/optimisers.h"

namespace e2lf::learn {
namespace {

constexpr double kBeta1 = 0.9, kBeta2 = 0.999, kEpsilon = 1e-8;

}  // namespace

Adam::Adam(const NamedTensors& parameters) {
  torch::NoGradGuard no_grad;
  for (const auto& [name, tensor] : parameters) {
    first_[name] = torch::zeros_like(tensor);
    second_[name] = torch::zeros_like(tensor);
  }
}

void Adam::update(const NamedTensors& parameters, double learning_rate, uint64_t step) {
  torch::NoGradGuard no_grad;
  const double correction1 = 1.0 - std::pow(kBeta1, static_cast<double>(step));
  const double correction2 = 1.0 - std::pow(kBeta2, static_cast<double>(step));
  for (const auto& [name, tensor] : parameters) {
    const auto gradient = tensor.grad();
    if (!gradient.defined()) continue;
    auto &first = first_.at(name), &second = second_.at(name);
    first.mul_(kBeta1).add_(gradient, 1.0 - kBeta1);
    second.mul_(kBeta2).addcmul_(gradient, gradient, 1.0 - kBeta2);
    const auto denominator = (second / correction2).sqrt_().add_(kEpsilon);
    auto parameter = tensor;
    parameter.addcdiv_(first, denominator, -learning_rate / correction1);
  }
}

double clip_gradients(const NamedTensors& parameters, double max_norm) {
  torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> norms;
  for (const auto& [name, tensor] : parameters) {
    if (tensor.grad().defined()) norms.push_back(tensor.grad().norm());
  }
  if (norms.empty()) return 0.0;
  const double norm = torch::stack(norms).norm().item<double>();
  if (norm > max_norm) {
    for (const auto& [name, tensor] : parameters) {
      if (tensor.grad().defined()) tensor.grad().mul_(max_norm / norm);
    }
  }
  return norm;
}

void zero_gradients(const NamedTensors& parameters) {
  for (const auto& [name, tensor] : parameters) {
    auto parameter = tensor;
    parameter.mutable_grad() = torch::Tensor();
  }
}

void update_average(const NamedTensors& average, const NamedTensors& parameters, double decay) {
  torch::NoGradGuard no_grad;
  for (const auto& [name, tensor] : average) {
    auto target = tensor;
    target.lerp_(parameters.at(name), 1.0 - decay);
  }
}

NamedTensors clone(const NamedTensors& tensors) {
  NamedTensors copies;
  for (const auto& [name, tensor] : tensors) copies[name] = tensor.detach().clone();
  return copies;
}

}  // namespace e2lf::learn
