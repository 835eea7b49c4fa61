// SPDX-License-Identifier: MIT
#pragma once

#include <torch/torch.h>

namespace e2lf::learn {

/// The share of the gradient that a ReLU lets through where it is off. With none, units that are off for every input
/// never come back: of the early models' units at the lowest resolution, nine in ten were lost so. Values are those of
/// a plain ReLU.
inline constexpr float kOffGradient = 0.02F;

/// max(x, 0), with that gradient.
inline torch::Tensor rectify(const torch::Tensor& x) {
  return torch::where(x > 0, x, kOffGradient * (x - x.detach()));
}

}  // namespace e2lf::learn
