// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

namespace e2lf::learn {

struct SynthesiserOptions {
  int64_t size = 96;               ///< height and width of the light fields, px
  double max_disparity = 3.0;      ///< px per view step, either sign
  int64_t max_layers = 6;          ///< a background and up to this many minus one occluders
  double slant_share = 0.5;        ///< share of surfaces whose disparity changes over the picture
  double highlight_share = 0.2;    ///< share of scenes with reflections at a depth of their own
  double procedural_share = 0.25;  ///< share of surfaces without a photograph
};

/// A random light field, uint8 [64, size, size]: textured planes, slanted or not, one behind another, with hard, soft
/// and fine occlusion edges, some with highlights. Textures are uint8 [y, x] photographs of at least 64x64; without
/// any, all are procedural. The draws depend on the seed alone; torch's generator is reseeded with it.
[[nodiscard]] torch::Tensor synthesise(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options,
                                       uint64_t seed, torch::Device device);

}  // namespace e2lf::learn
