// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2lf/learn/data/batches.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/learn/run/config.h"
#include "e2lf/learn/run/run_log.h"

namespace e2lf::learn {

/// The loss of a batch, whose gradient is computed, and the figure that is logged beside it.
struct StepLoss {
  torch::Tensor loss, figure;
};

/// How a model is judged: as recorded by a camera over a number of cycles. `seed` determines the noise.
struct Judgement {
  const capture::SensorProfile& camera;
  size_t cycles = 1;
  uint64_t seed = 0;
};

/// What a run learns, views, disparity or a picture: its samples, its network, its loss and its figures. A run opens
/// one task, and its trainer knows no others.
class Task {
 public:
  virtual ~Task() = default;

  /// Returns the network, whose parameters are trained.
  [[nodiscard]] virtual const NetworkModule& network() const = 0;

  /// Returns the weights that Muon updates if train.optimiser is "muon"; Adam updates the others.
  [[nodiscard]] virtual NamedTensors weights_of_muon() const = 0;

  /// Returns the weights of a model from which a run starts, as far as this network has them. Fails with kInvalidValue
  /// if it can have none of them.
  [[nodiscard]] virtual Result<model::Weights> starting_weights(const model::Model& model) const = 0;

  /// Computes the loss of a share of the batch of a step with the present patterns, [N, 64]. `input_means`: see
  /// NetworkModule::forward().
  [[nodiscard]] virtual Result<StepLoss> loss(uint64_t step, Share share, const torch::Tensor& codes,
                                              NamedTensors* input_means) = 0;

  /// Evaluates weights on a scene of the data: a score for each set of patterns that is judged. Fails with kNotFound if
  /// the data do not contain the scene, or not what it is judged by.
  [[nodiscard]] virtual Result<std::vector<SceneScore>> evaluate(const NamedTensors& weights,
                                                                 const torch::Tensor& codes, const std::string& scene,
                                                                 const Judgement& judgement) const = 0;

  /// Adds weights and their network to a model that has all other properties.
  [[nodiscard]] virtual Result<model::Model> complete(model::Model model, const NamedTensors& weights) const = 0;

  [[nodiscard]] virtual LogFigures figures() const = 0;

  /// Returns the data, the scenes for evaluation and the camera of the run.
  [[nodiscard]] virtual const SampleSource& samples() const = 0;
};

/// Opens the task of a configuration: reads the data and initialises the network. Sets patterns.num_patterns where it
/// follows from patterns.codes. Fails as read_dataset(), Batches::create() and, for patterns, read_pattern_set() do.
[[nodiscard]] Result<std::unique_ptr<Task>> open_task(Config& config, torch::Device device);

/// Opens the task of networks of views, and those of networks of disparity and of views on moved pictures for any
/// patterns.
[[nodiscard]] Result<std::unique_ptr<Task>> open_views_task(const Config& config, Dataset dataset,
                                                            torch::Device device);
[[nodiscard]] Result<std::unique_ptr<Task>> open_any_patterns_task(Config& config, Dataset dataset,
                                                                   torch::Device device);

/// An error of a disparity that counts as wrong, px per view step.
inline constexpr double kWrongDisparity = 0.2;

/// Computes the loss of outputs [batch, 2, y, x] (the disparity, and the logarithm of its scale): the negative
/// logarithm of a Laplace likelihood, and a bounded error that prefers the likeliest disparity to the median; and the
/// share of disparities that are wrong. Both are means over the pixels whose disparity [batch, y, x] is not NaN.
[[nodiscard]] StepLoss depth_loss(const torch::Tensor& output, const torch::Tensor& disparity);

/// Seeds torch's generator for the initial weights of a run.
void seed_initial_weights(const Config& config);

}  // namespace e2lf::learn
