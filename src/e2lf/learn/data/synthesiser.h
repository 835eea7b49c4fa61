// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

namespace e2lf::learn {

struct SynthesiserOptions {
  int64_t size = 96;               ///< height and width of the light fields, px
  double max_disparity = 3.0;      ///< largest absolute disparity, px per view step
  int64_t max_layers = 6;          ///< largest number of surfaces: a background and occluders
  double slant_share = 0.5;        ///< share of surfaces whose disparity varies over the image
  double highlight_share = 0.2;    ///< share of scenes with reflections at a depth of their own
  double procedural_share = 0.25;  ///< share of surfaces with a procedural texture
  double motion_px_per_cycle = 0;  ///< largest speed of a surface
  double still_share = 0.5;        ///< share of scenes that stand still, if others move
};

/// A light field at several times.
struct MovingScene {
  torch::Tensor views;     ///< the scene at time 0, uint8 [64, size, size]
  torch::Tensor at_times;  ///< uint8 [times, 64, size, size]; undefined if the scene stands still
};

/// Synthesises a random light field: textured planes behind one another, slanted or not, with hard, soft and fine
/// occlusion edges, some with highlights. `textures` are photographs uint8 [y, x] of at least 64x64 px; if there are
/// none, all textures are procedural. The result depends only on `seed`, with which torch's generator is reseeded. If
/// there are `times`, in cycles, the surfaces move at constant velocities of up to options.motion_px_per_cycle, in one
/// direction together or each in its own.
[[nodiscard]] MovingScene synthesise(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options,
                                     uint64_t seed, torch::Device device, const std::vector<double>& times = {});

}  // namespace e2lf::learn
