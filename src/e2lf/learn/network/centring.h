// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {

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
