// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/model/composition.h"

/// The training of networks of the central picture, each of whose samples has patterns of its own.
namespace e2lf::learn {

/// The layers of e2lf-any for the central picture, with widths of the levels from half of the resolution on. The input
/// is model::InputKind::kCentral.
[[nodiscard]] model::Network picture_network(const std::vector<size_t>& widths);

/// What such a network reads, and the picture to which its output is added.
struct CentralPictures {
  torch::Tensor planes;  ///< [batch, model::kCentralPlanes, y, x]
  torch::Tensor base;    ///< [batch, y, x]
};

/// Moves the pictures behind the patterns of each sample to the central view. `disparity` [batch, 2, y, x] is the
/// output of a network of disparity for `inputs`, and `central` states how the planes are made of both.
[[nodiscard]] CentralPictures move_to_centre(const DepthInputs& inputs, const torch::Tensor& disparity,
                                             const std::vector<model::CentralInput>& central);

}  // namespace e2lf::learn
