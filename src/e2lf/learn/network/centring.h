// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {

/// Centring (Schraudolph, 1998): convolutions y = W * x + b learn as if written y = W * (x - m) + c with the means m of
/// their input channels, so that what is common to all pixels is the bias's business alone. Activations behind ReLUs
/// have large means; without this, steps of W move hidden units as a whole, until they are off for every input and
/// lost. The functions do one half each: gradients before a step of any optimiser, biases after it. `input_means`: [in]
/// by layer, for the convolutions to be centred. What zero padding changes at the border is left out.

/// dL/dW -= dL/db m^T, for each tap: the gradient with c instead of b kept. Layers without a gradient stay.
void centre_gradients(const NamedTensors& parameters, const NamedTensors& input_means);

/// b -= (W - W before the step) * m: c moves as the optimiser moved b.
void keep_mean_outputs(const NamedTensors& parameters, const NamedTensors& before, const NamedTensors& input_means);

}  // namespace e2lf::learn
