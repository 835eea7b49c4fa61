// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/centring.h"

namespace e2lf::learn {

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
