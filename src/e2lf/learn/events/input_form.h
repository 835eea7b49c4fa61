// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/model/model.h"

namespace e2lf::learn {

/// Computes the input channels of the network, [batch, model::num_input_channels(), y, x], from event images [batch, N
/// - 1, y, x] and intensity images [batch, images, y, x], if there are any, as model::InputGroup defines them.
/// Differentiable. Uses eps, tau and the conditioning vector of each sample.
[[nodiscard]] torch::Tensor form_inputs(const torch::Tensor& events, const std::vector<model::InputGroup>& groups,
                                        const SampleConstants& constants, const torch::Tensor& images = {});

/// Returns the origins of the input channels of a network for N patterns in a model with other groups or fewer
/// patterns. The origin of a channel is the same transition, or the same number of the conditioning vector, in the
/// group of the same kind. The factors compensate for different scales of the groups.
[[nodiscard]] std::vector<InputOrigin> input_origins(const model::Model& start,
                                                     const std::vector<model::InputGroup>& groups, size_t num_patterns);

}  // namespace e2lf::learn
