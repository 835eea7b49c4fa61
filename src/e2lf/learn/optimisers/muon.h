// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {

/// Muon (Jordan et al., 2024): weights move by the momentum of their gradient with all singular values made about
/// alike, so that rare directions are learned as fast as common ones. Its steps have the size of Adam's (Liu et al.,
/// 2025), one learning rate serves both. Its whole state is open, so that a checkpoint can hold it.
class Muon {
 public:
  /// For weights of convolutions, [out, in, kernel, kernel] or, transposed, [in, out, kernel, kernel].
  explicit Muon(const NamedTensors& weights);

  /// Updates the weights from their gradients. Weights without a gradient stay.
  void update(const NamedTensors& weights, double learning_rate);

  [[nodiscard]] const NamedTensors& momenta() const { return momenta_; }

 private:
  NamedTensors momenta_;
};

/// The weights of a network that Muon is for: of all convolutions larger than 1x1 but the last, which gives the views.
[[nodiscard]] NamedTensors muon_weights(const NetworkModule& network);

/// A matrix with the same singular vectors whose singular values s (divided by the Frobenius norm + 1e-8) become
/// f(f(f(f(f(s))))) with f(s) = 3.4445 s - 4.775 s^3 + 2.0315 s^5: between 0.65 and 1.25 where s > 0.01. Gradients far
/// below 1e-8, as of layers whose units are all off, become almost zero.
[[nodiscard]] torch::Tensor orthogonalise(const torch::Tensor& matrix);

}  // namespace e2lf::learn
