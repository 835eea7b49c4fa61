// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/model/model.h"

namespace e2lf::model {

/// The number of outputs of a depth network: the disparity of view (views_y / 2, views_x / 2) in px per view step, and
/// the logarithm of its scale. They are the parameters of a Laplace distribution.
inline constexpr size_t kDepthOutputs = 2;

/// Returns true if a network gives disparities instead of views: it has kDepthOutputs outputs.
[[nodiscard]] bool is_depth_network(const Model& model);

}  // namespace e2lf::model
