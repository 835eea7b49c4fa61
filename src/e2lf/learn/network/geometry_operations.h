// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

#include "e2lf/learn/network/network_module.h"

/// The operations of e2lf/geometry as differentiable torch operations, which move pictures by slices with the weights
/// of at most four neighbours along an axis.
namespace e2lf::learn {

/// Compares pictures at each of K disparities as geometry::GeometryOp::kPlaneSweep does: pictures [batch, P, G, y, x]
/// to [batch, K, y, x]. `offsets` [batch, P, 2] on the CPU are those of each sample, in pixels of the pictures per unit
/// of the disparity; [1, P, 2] if they are the same for all. Computes in the type of the pictures; gradients are those
/// with respect to the pictures.
[[nodiscard]] torch::Tensor sweep_planes(const torch::Tensor& pictures, const torch::Tensor& offsets,
                                         const std::vector<double>& disparities, int64_t window);

/// Layers of geometry::GeometryOp::kPlaneSweep, geometry::GeometryOp::kRenderLayers and geometry::GeometryOp::kWarp.
/// All compute in float32 at least, because evidence is small, opacities are near 1, and places are fractions of a
/// pixel.
[[nodiscard]] torch::Tensor apply_plane_sweep(const TorchCall& call);
[[nodiscard]] torch::Tensor apply_render_layers(const TorchCall& call);
[[nodiscard]] torch::Tensor apply_warp(const TorchCall& call);

}  // namespace e2lf::learn
