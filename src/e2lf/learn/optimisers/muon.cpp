// SPDX-License-Identifier: MIT
// Implements Muon of optimisers.h.
#include <algorithm>
#include <cmath>

#include "e2lf/learn/optimisers/optimisers.h"

namespace e2lf::learn {
namespace {

constexpr double kMomentum = 0.95;
constexpr double kSize = 0.2;      // root mean square of Adam's typical steps, in learning rates
constexpr double kEpsilon = 1e-8;  // as in Adam: weights with hardly any gradient hardly move
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

}  // namespace

Muon::Muon(const NamedTensors& weights) {
  torch::NoGradGuard no_grad;
  for (const auto& [name, tensor] : weights) momenta_[name] = torch::zeros_like(tensor);
}

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

}  // namespace e2lf::learn
