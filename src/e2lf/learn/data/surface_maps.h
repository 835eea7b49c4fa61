// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

#include "e2lf/learn/data/draws.h"

namespace e2lf::learn {

/// Random brightness map in [0, 1], float32 [side, side]: a piece of a photograph, resized and toned.
[[nodiscard]] torch::Tensor photo_texture(const std::vector<torch::Tensor>& photos, int64_t side, Draws& draws);

/// The same from stripes, noise of several octaves, smooth shading, or a flat tone.
[[nodiscard]] torch::Tensor procedural_texture(int64_t side, Draws& draws, torch::Device device);

/// Random coverage map in [0, 1], float32 [side, side], of a surface that hides a part of what is behind it: half
/// planes, ellipses, bars, blobs or the fine structure of `texture`; edges from one to about eight px wide.
[[nodiscard]] torch::Tensor coverage(const torch::Tensor& texture, Draws& draws);

/// A few soft bright spots in [0, 1], float32 [side, side].
[[nodiscard]] torch::Tensor highlights(int64_t side, Draws& draws, torch::Device device);

}  // namespace e2lf::learn
