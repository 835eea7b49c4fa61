// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {

/// The optimiser Adam (Kingma and Ba, 2015) with bias correction, in float32. Its complete state is accessible for
/// checkpoints.
class Adam {
 public:
  /// `second_decay` is that of the second moments; the other constants are the default ones.
  explicit Adam(const NamedTensors& parameters, double second_decay = 0.999);

  /// Updates the parameters from their gradients; `step` is counted from 1. Parameters without a gradient are
  /// unchanged.
  void update(const NamedTensors& parameters, double learning_rate, uint64_t step);

  [[nodiscard]] const NamedTensors& first_moments() const { return first_; }
  [[nodiscard]] const NamedTensors& second_moments() const { return second_; }

 private:
  NamedTensors first_, second_;
  double second_decay_;
};

/// The optimiser Muon (Jordan et al., 2024). It moves weights along the momentum of their gradient after making all
/// singular values of the momentum approximately equal, so that rare directions are learned as fast as common ones. Its
/// steps have the size of Adam's (Liu et al., 2025), so that one learning rate serves both. Its complete state is
/// accessible for checkpoints.
class Muon {
 public:
  /// Creates the state for weights of convolutions, [out, in, kernel, kernel], or transposed ones, [in, out, kernel,
  /// kernel].
  explicit Muon(const NamedTensors& weights);

  /// Updates the weights from their gradients. Weights without a gradient are unchanged.
  void update(const NamedTensors& weights, double learning_rate);

  [[nodiscard]] const NamedTensors& momenta() const { return momenta_; }

 private:
  NamedTensors momenta_;
};

/// Returns the weights of a network that Muon should update: those of all convolutions larger than 1x1 except the last,
/// whose outputs are the views.
[[nodiscard]] NamedTensors muon_weights(const NetworkModule& network);

/// Returns a matrix with the same singular vectors, whose singular values s (divided by the Frobenius norm + 1e-8)
/// become f(f(f(f(f(s))))) with f(s) = 3.4445 s - 4.775 s^3 + 2.0315 s^5. The results lie between 0.65 and 1.25 if s >
/// 0.01. Gradients far below 1e-8, such as those of layers whose units are all zero, become almost zero.
[[nodiscard]] torch::Tensor orthogonalise(const torch::Tensor& matrix);

/// Scales the gradients so that their joint Euclidean norm is at most `max_norm`. Returns the norm before scaling.
double clip_gradients(const NamedTensors& parameters, double max_norm);

void zero_gradients(const NamedTensors& parameters);

/// Updates a moving average: average = decay * average + (1 - decay) * parameters.
void update_average(const NamedTensors& average, const NamedTensors& parameters, double decay);

/// Returns copies that share no memory with the originals and do not require gradients.
[[nodiscard]] NamedTensors clone(const NamedTensors& tensors);

/// Centring (Schraudolph, 1998). A convolution y = W * x + b is trained as if it were written y = W * (x - m) + c,
/// where m are the means of its input channels, so that only the bias learns what all pixels have in common. The
/// activations after a ReLU have large means. Without centring, an update of W shifts a hidden unit as a whole, until
/// it is zero for every input and can no longer learn. One function below changes the gradients before the step of an
/// optimiser, the other the biases after it. `input_means` contains m, [in], for each layer to be centred. The effect
/// of zero padding at the border is ignored.

/// Subtracts dL/db m^T from dL/dW for each tap, which gives the gradient with respect to W at constant c instead of
/// constant b. Layers without a gradient are skipped.
void centre_gradients(const NamedTensors& parameters, const NamedTensors& input_means);

/// Subtracts (W - W before the step) * m from b, so that c changes by the optimiser's step of b.
void keep_mean_outputs(const NamedTensors& parameters, const NamedTensors& before, const NamedTensors& input_means);

}  // namespace e2lf::learn
