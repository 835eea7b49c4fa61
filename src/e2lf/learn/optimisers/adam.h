// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {

/// The optimiser Adam (Kingma and Ba, 2015) with its default constants and bias correction, in float32. Its complete
/// state is accessible for checkpoints.
class Adam {
 public:
  explicit Adam(const NamedTensors& parameters);

  /// Updates the parameters from their gradients; `step` is counted from 1. Parameters without a gradient are
  /// unchanged.
  void update(const NamedTensors& parameters, double learning_rate, uint64_t step);

  [[nodiscard]] const NamedTensors& first_moments() const { return first_; }
  [[nodiscard]] const NamedTensors& second_moments() const { return second_; }

 private:
  NamedTensors first_, second_;
};

/// Scales the gradients so that their joint Euclidean norm is at most `max_norm`. Returns the norm before scaling.
double clip_gradients(const NamedTensors& parameters, double max_norm);

void zero_gradients(const NamedTensors& parameters);

/// Updates a moving average: average = decay * average + (1 - decay) * parameters.
void update_average(const NamedTensors& average, const NamedTensors& parameters, double decay);

/// Returns copies that share no memory with the originals and do not require gradients.
[[nodiscard]] NamedTensors clone(const NamedTensors& tensors);

}  // namespace e2lf::learn
