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

/// Synthesises a random light field, uint8 [64, size, size]: textured planes behind one another, slanted or not, with
/// hard, soft and fine occlusion edges, some with highlights. `textures` are photographs uint8 [y, x] of at least 64x64
/// px; if there are none, all textures are procedural. The result depends only on `seed`, with which torch's generator
/// is reseeded.
[[nodiscard]] torch::Tensor synthesise(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options,
                                       uint64_t seed, torch::Device device);

/// A synthesised scene at several times.
struct MovingScene {
  torch::Tensor views;     ///< what synthesise() returns: the scene at time 0
  torch::Tensor at_times;  ///< uint8 [times, 64, size, size]; undefined if the scene stands still
};

/// Synthesises a scene whose surfaces move at constant velocities, in one direction together or each in its own, of up
/// to options.motion_px_per_cycle, and returns it at time 0 and at the given times in cycles.
[[nodiscard]] MovingScene synthesise_moving(const std::vector<torch::Tensor>& textures,
                                            const SynthesiserOptions& options, uint64_t seed, torch::Device device,
                                            const std::vector<double>& times);

}  // namespace e2lf::learn
