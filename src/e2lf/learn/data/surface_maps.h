// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

#include "e2lf/learn/data/draws.h"

namespace e2lf::learn {

/// Returns a random brightness map in [0, 1], float32 [side, side]: a crop of a photograph, resized, with a random tone
/// curve.
[[nodiscard]] torch::Tensor photo_texture(const std::vector<torch::Tensor>& photos, int64_t side, Draws& draws);

/// Returns a random brightness map of stripes, noise of several octaves, smooth shading, or a constant.
[[nodiscard]] torch::Tensor procedural_texture(int64_t side, Draws& draws, torch::Device device);

/// Returns a random coverage map in [0, 1], float32 [side, side], of a surface that occludes a part of the surfaces
/// behind it: half planes, ellipses, bars, blobs or the fine structure of `texture`. The edges are one to about eight
/// px wide.
[[nodiscard]] torch::Tensor coverage(const torch::Tensor& texture, Draws& draws);

/// Returns a map of a few soft bright spots in [0, 1], float32 [side, side].
[[nodiscard]] torch::Tensor highlights(int64_t side, Draws& draws, torch::Device device);

}  // namespace e2lf::learn
