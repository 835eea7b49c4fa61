// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/model/model.h"

namespace e2lf::learn {

/// The network's input channels from event images [batch, N - 1, y, x] and intensity images [batch, images, y, x],
/// where there are any, as model::InputGroup defines them: [batch, model::num_input_channels(), y, x], differentiable.
/// Uses eps, tau and the conditioning of each sample.
[[nodiscard]] torch::Tensor form_inputs(const torch::Tensor& events, const std::vector<model::InputGroup>& groups,
                                        const SampleConstants& constants, const torch::Tensor& images = {});

/// Where the input channels of a network for N patterns come from in a model with other groups or fewer patterns: the
/// same transition, or trait of the camera, of the group of the same kind; its weights follow the groups' scales.
[[nodiscard]] std::vector<InputOrigin> input_origins(const model::Model& start,
                                                     const std::vector<model::InputGroup>& groups, size_t num_patterns);

}  // namespace e2lf::learn
