// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <memory>
#include <torch/types.h>
#include <vector>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/data/batches.h"
#include "e2lf/learn/data/conditions.h"
#include "e2lf/learn/data/known_scenes.h"

namespace e2lf::learn {

/// Samples with known disparity, each with patterns of its own.
struct DepthBatch {
  torch::Tensor events;               ///< [batch, transitions, y, x], averaged over the cycles
  torch::Tensor cycles;               ///< their number, float32 [batch, y, x]
  torch::Tensor disparity;            ///< of view (4, 4), px per view step, float32 [batch, y, x]
  std::vector<capture::Codes> codes;  ///< the patterns of each sample: black first, or a whole cycle
  SampleConstants constants;          ///< with conditioning vectors for one cycle
};

/// Training samples for disparity. The batch of step k depends only on the configuration and k.
class DepthBatches {
 public:
  /// `known`: sets of patterns of which some are taken. `camera`: as Batches::camera().
  DepthBatches(const Config& config, const Dataset& dataset, std::vector<capture::Codes> known,
               std::optional<capture::SensorProfile> camera, torch::Device device);

  /// Returns a share of the batch of a step, as Batches::at() does.
  [[nodiscard]] DepthBatch at(uint64_t step, Share share = {});

 private:
  void advance_pool(uint64_t step);

  Config config_;
  std::vector<capture::Codes> known_;
  std::optional<capture::SensorProfile> camera_;
  torch::Device device_;
  std::unique_ptr<KnownScenes> scenes_;
  uint64_t pool_end_ = 0;  ///< number of scenes drawn since step 0
  std::deque<KnownScene> pool_;
};

/// Applies one of the eight symmetries of transform_views() to the views and the disparity of a scene. Returns the
/// views, uint8 [64, y, x], and the disparity of view (4, 4), [y, x].
[[nodiscard]] std::pair<torch::Tensor, torch::Tensor> transform_scene(const KnownScene& scene, unsigned symmetry);

/// Simulates the events of views [batch, 64, y, x] through the patterns of each sample, with new noise from torch's
/// generator: [batch, N - 1, y, x], averaged over cycles [batch, y, x]. `most_residue` [batch]: see Conditions.
[[nodiscard]] torch::Tensor simulate_cycles(const torch::Tensor& views, const std::vector<capture::Codes>& codes,
                                            const SampleConstants& constants, const torch::Tensor& most_residue,
                                            const torch::Tensor& cycles);

}  // namespace e2lf::learn
