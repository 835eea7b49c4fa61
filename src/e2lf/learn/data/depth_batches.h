// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <torch/types.h>
#include <vector>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/data/batches.h"
#include "e2lf/learn/data/known_scenes.h"

namespace e2lf::learn {

/// Samples with known disparity, each with patterns of its own.
struct DepthBatch {
  torch::Tensor events;     ///< [batch, transitions, y, x], averaged over the cycles
  torch::Tensor cycles;     ///< their number, float32 [batch, y, x]
  torch::Tensor disparity;  ///< of view (4, 4), px per view step, NaN if it is not known, float32 [batch, y, x]
  torch::Tensor views;      ///< of the scene that the events are of, float32 [batch, 64, y, x]
  torch::Tensor gain;       ///< by which it is darker than the one it was made of, float32 [batch]
  std::vector<capture::Codes> codes;  ///< the patterns of each sample: black first, or a whole cycle
  SampleConstants constants;          ///< with conditioning vectors for one cycle
};

/// Training samples for disparity. The batch of step k depends only on the configuration and k.
class DepthBatches : public SampleSource {
 public:
  /// `codes`: the patterns of patterns.codes. Reads the sets of patterns.known. Of the scenes of the data, those for
  /// training whose disparities are known for all four central views give the samples that are not synthesised. Fails
  /// with kInvalidValue (there are none, but data.synthetic_share is below 1), and as read_pattern_set() and
  /// Batches::create() do.
  [[nodiscard]] static Result<DepthBatches> create(const Config& config, capture::Codes codes, Dataset dataset,
                                                   torch::Device device);

  /// Returns a share of the batch of a step, as Batches::at() does.
  [[nodiscard]] DepthBatch at(uint64_t step, Share share = {});

 private:
  DepthBatches(const Config& config, capture::Codes codes, Dataset dataset, torch::Device device);
  [[nodiscard]] KnownScene random_scene(Draws& draws) const;
  [[nodiscard]] std::vector<capture::Codes> draw_codes(Draws& draws) const;

  capture::Codes codes_;
  std::vector<capture::Codes> known_;
  std::unique_ptr<KnownScenes> synthesised_;
  std::deque<KnownScene> pool_;
};

/// Cuts a random square out of a scene with four maps, and scales it to `size`, by 0.7 to 2 as far as it is large
/// enough. Its disparities are scaled with it.
[[nodiscard]] KnownScene scaled_part(const Scene& scene, int64_t size, Draws& draws);

/// Applies one of the eight symmetries of transform_views() to the views and the disparity of a scene. Returns the
/// views, uint8 [64, y, x], and the disparity of view (4, 4), [y, x].
[[nodiscard]] std::pair<torch::Tensor, torch::Tensor> transform_scene(const KnownScene& scene, unsigned symmetry);

/// Simulates the events of views [batch, 64, y, x] through the patterns of each sample, with new noise from torch's
/// generator: [batch, N - 1, y, x], averaged over cycles [batch, y, x]. `most_residue` [batch]: see Conditions.
[[nodiscard]] torch::Tensor simulate_cycles(const torch::Tensor& views, const std::vector<capture::Codes>& codes,
                                            const SampleConstants& constants, const torch::Tensor& most_residue,
                                            const torch::Tensor& cycles);

}  // namespace e2lf::learn
