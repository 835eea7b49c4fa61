// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/learn/data/depth_batches.h"
#include "e2lf/learn/network/any_patterns.h"
#include "e2lf/learn/run/run_log.h"

namespace e2lf::learn {

/// An error of a disparity that counts as wrong, px per view step.
inline constexpr double kWrongDisparity = 0.2;

/// The loss of a batch, and the share of its disparities that are wrong.
struct DepthLoss {
  torch::Tensor loss, share_off;
};

/// Computes the loss of outputs [batch, 2, y, x] (the disparity, and the logarithm of its scale): the negative
/// logarithm of a Laplace likelihood, and a bounded error that prefers the likeliest disparity to the median.
[[nodiscard]] DepthLoss depth_loss(const torch::Tensor& output, const torch::Tensor& disparity);

/// What a run that trains a network of disparity for any patterns learns from, and how it is judged.
class DepthTask {
 public:
  /// `known`: see DepthBatches; `codes` are those for which models are stored and evaluated.
  DepthTask(const Config& config, const Dataset& dataset, std::vector<capture::Codes> known, capture::Codes codes,
            const std::optional<capture::SensorProfile>& camera, torch::Device device);

  [[nodiscard]] const NetworkModule& network() const { return network_.module(); }

  /// Computes the loss of a share of the batch of a step. Fails if patterns are drawn that cannot be described.
  [[nodiscard]] Result<DepthLoss> loss(uint64_t step, Share share, NamedTensors* input_means);

  /// Evaluates weights on a scene with known disparity, as recorded by a camera: the share of disparities that are
  /// wrong, in %, without a border of 15 px. The right and lower edges are cropped to what the network takes. Fails
  /// with kNotFound if the disparity of the scene is not known.
  [[nodiscard]] Result<SceneScore> evaluate(const NamedTensors& weights, const Scene& scene,
                                            const capture::SensorProfile& camera, size_t cycles, uint64_t seed) const;

  /// Completes a model with weights for any patterns, which are adapted to the codes of the model, at two scales.
  [[nodiscard]] Result<model::Model> complete(model::Model model, const NamedTensors& weights) const;

 private:
  [[nodiscard]] DepthInputs inputs_of(const torch::Tensor& events, const SampleConstants& constants,
                                      const torch::Tensor& cycles) const;

  Config config_;
  DepthBatches batches_;
  AnyPatternsModule network_;
  capture::Codes codes_;
  torch::ScalarType compute_;
  torch::Device device_;
};

/// Adds two synthesised scenes with known disparity to a data set, and returns their names.
[[nodiscard]] std::vector<std::string> add_known_scenes(const Config& config, torch::Device device, Dataset& dataset);

}  // namespace e2lf::learn
