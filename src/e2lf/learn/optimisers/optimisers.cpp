// SPDX-License-Identifier: MIT
#include "e2lf/learn/optimisers/optimisers.h"

#include <algorithm>
#include <cmath>

namespace e2lf::learn {
namespace {

constexpr double kBeta1 = 0.9;
constexpr double kEpsilon = 1e-8;  // of Muon, too: weights with hardly any gradient hardly move

constexpr double kMomentum = 0.95;
constexpr double kSize = 0.2;  // root mean square of Adam's typical steps, in learning rates
constexpr int kIterations = 5;
constexpr double kLinear = 3.4445, kCubic = -4.7750, kQuintic = 2.0315;

/// Returns the weights as a matrix, in the order in which our kernels store those of 3x3 convolutions, which are
/// therefore not copied.
torch::Tensor as_matrix(const torch::Tensor& weights) {
  return weights.permute({2, 3, 1, 0}).reshape({-1, weights.size(0)});
}

torch::Tensor as_weights(const torch::Tensor& matrix, const torch::Tensor& like) {
  return matrix.reshape({like.size(2), like.size(3), like.size(1), like.size(0)}).permute({3, 2, 0, 1});
}

NamedTensors zeros_like(const NamedTensors& tensors) {
  torch::NoGradGuard no_grad;
  NamedTensors zeros;
  for (const auto& [name, tensor] : tensors) zeros[name] = torch::zeros_like(tensor);
  return zeros;
}

}  // namespace

Adam::Adam(const NamedTensors& parameters, double second_decay)
    : first_(zeros_like(parameters)), second_(zeros_like(parameters)), second_decay_(second_decay) {}

void Adam::update(const NamedTensors& parameters, double learning_rate, uint64_t step) {
  torch::NoGradGuard no_grad;
  const double correction1 = 1.0 - std::pow(kBeta1, static_cast<double>(step));
  const double correction2 = 1.0 - std::pow(second_decay_, static_cast<double>(step));
  for (const auto& [name, tensor] : parameters) {
    const auto gradient = tensor.grad();
    if (!gradient.defined()) continue;
    auto &first = first_.at(name), &second = second_.at(name);
    first.mul_(kBeta1).add_(gradient, 1.0 - kBeta1);
    second.mul_(second_decay_).addcmul_(gradient, gradient, 1.0 - second_decay_);
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

Muon::Muon(const NamedTensors& weights) : momenta_(zeros_like(weights)) {}

void Muon::update(const NamedTensors& weights, double learning_rate) {
  torch::NoGradGuard no_grad;
  for (const auto& [name, tensor] : weights) {
    const auto gradient = tensor.grad();
    if (!gradient.defined()) continue;
    auto& momentum = momenta_.at(name);
    momentum.lerp_(gradient, 1.0 - kMomentum);
    // Nesterov's variant: one step further along the momentum.
    const auto direction = orthogonalise(as_matrix(momentum.lerp(gradient, 1.0 - kMomentum)));
    const auto size = kSize * std::sqrt(static_cast<double>(std::max(direction.size(0), direction.size(1))));
    auto weight = tensor;
    weight.sub_(as_weights(direction, weight), learning_rate * size);
  }
}

NamedTensors muon_weights(const NetworkModule& network) {
  NamedTensors weights;
  const auto& layers = network.network().layers;
  for (const auto& layer : layers) {
    const auto found = network.parameters().find(layer.name + ".weight");
    if (found == network.parameters().end() || layer.kernel == 1 || &layer == &layers.back()) continue;
    weights.insert(*found);
  }
  return weights;
}

/// Applies the Newton-Schulz iteration to the small matrix X^T X instead of X: the matrix by which X is multiplied in
/// total is a polynomial of it.
torch::Tensor orthogonalise(const torch::Tensor& matrix) {
  const bool is_wide = matrix.size(0) < matrix.size(1);
  auto tall = is_wide ? matrix.t() : matrix;
  tall = tall / (tall.norm() + kEpsilon);
  auto gram = torch::mm(tall.t(), tall);
  torch::Tensor product;
  for (int i = 0; i < kIterations; ++i) {
    auto factor = torch::addmm(gram, gram, gram, kCubic, kQuintic);
    factor.diagonal().add_(kLinear);
    product = i == 0 ? factor : torch::mm(product, factor);
    if (i + 1 < kIterations) gram = torch::mm(torch::mm(factor, gram), factor);
  }
  const auto result = torch::mm(tall, product);
  return is_wide ? result.t() : result;
}

void centre_gradients(const NamedTensors& parameters, const NamedTensors& input_means) {
  torch::NoGradGuard no_grad;
  for (const auto& [layer, mean] : input_means) {
    const auto of_weight = parameters.at(layer + ".weight").grad(), of_bias = parameters.at(layer + ".bias").grad();
    if (!of_weight.defined() || !of_bias.defined()) continue;
    of_weight.sub_(torch::outer(of_bias, mean).unsqueeze(-1).unsqueeze(-1));
  }
}

void keep_mean_outputs(const NamedTensors& parameters, const NamedTensors& before, const NamedTensors& input_means) {
  torch::NoGradGuard no_grad;
  for (const auto& [layer, mean] : input_means) {
    const auto step = parameters.at(layer + ".weight") - before.at(layer + ".weight");
    auto bias = parameters.at(layer + ".bias");
    bias.sub_(torch::mv(step.sum({2, 3}), mean));
  }
}

}  // namespace e2lf::learn
