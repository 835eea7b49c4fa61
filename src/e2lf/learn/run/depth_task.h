// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/learn/run/task.h"

namespace e2lf::learn {

/// An error of a disparity that counts as wrong, px per view step.
inline constexpr double kWrongDisparity = 0.2;

/// Computes the loss of outputs [batch, 2, y, x] (the disparity, and the logarithm of its scale): the negative
/// logarithm of a Laplace likelihood, and a bounded error that prefers the likeliest disparity to the median; and the
/// share of disparities that are wrong. Both are means over the pixels whose disparity [batch, y, x] is not NaN.
[[nodiscard]] StepLoss depth_loss(const torch::Tensor& output, const torch::Tensor& disparity);

}  // namespace e2lf::learn
